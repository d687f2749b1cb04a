//! Trees of well-known text: `KEYWORD["name",1.0,CHILD[...]]`.

/// Deepest nesting; a compound system has six.
const DEEPEST: usize = 32;

/// A keyword with its values.
#[derive(Clone, Debug)]
pub(super) struct Node<'a> {
    keyword: &'a str,
    /// Texts without their quotes, and numbers and words, in their order.
    values: Vec<&'a str>,
    children: Vec<Node<'a>>,
    /// The text from the keyword to its bracket.
    pub(super) text: &'a str,
}

impl<'a> Node<'a> {
    /// The tree of a text; `None` if that is not well-known text.
    pub(super) fn parse(text: &'a str) -> Option<Self> {
        let (node, rest) = node(text, 0)?;
        rest.trim().is_empty().then_some(node)
    }

    fn is(&self, keywords: &[&str]) -> bool {
        keywords
            .iter()
            .any(|word| self.keyword.eq_ignore_ascii_case(word))
    }

    /// The system in plan view, in this node or of the first child that has one.
    pub(super) fn horizontal(&self) -> Option<&Self> {
        if self.is(&["PROJCS", "PROJCRS", "PROJECTEDCRS"]) || self.is_geographic() {
            return Some(self);
        }
        let parts = ["COMPD_CS", "COMPOUNDCRS", "BOUNDCRS", "SOURCECRS"];
        let is_group = self.is(&parts);
        is_group.then(|| self.children.iter().find_map(Self::horizontal))?
    }

    pub(super) fn is_geographic(&self) -> bool {
        self.is(&["GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS"])
    }

    /// The first value.
    pub(super) fn name(&self) -> &'a str {
        self.values.first().copied().unwrap_or_default()
    }

    /// Code of the node itself, from `AUTHORITY["EPSG","25833"]` or `ID["EPSG",25833]`.
    pub(super) fn epsg(&self) -> Option<u16> {
        let ids = self.children.iter().filter(|c| c.is(&["AUTHORITY", "ID"]));
        let mut of_epsg = ids.filter(|c| c.name().eq_ignore_ascii_case("EPSG"));
        of_epsg.find_map(|id| id.values.get(1)?.parse().ok())
    }

    /// Length of the unit of a projected system; m.
    pub(super) fn unit(&self) -> Option<f64> {
        let own = self.children.iter().find(|c| c.is(&["UNIT", "LENGTHUNIT"]));
        let of_axis = || {
            let axis = self.children.iter().find(|c| c.is(&["AXIS"]))?;
            axis.children.iter().find(|c| c.is(&["UNIT", "LENGTHUNIT"]))
        };
        own.or_else(of_axis)?.values.get(1)?.parse().ok()
    }

    /// Values of the parameters of the projection.
    pub(super) fn parameters(&self) -> Vec<f64> {
        let of_conversion = self.children.iter().filter(|c| c.is(&["CONVERSION"]));
        let all = of_conversion
            .flat_map(|c| &c.children)
            .chain(&self.children);
        let parameters = all.filter(|c| c.is(&["PARAMETER"]));
        parameters
            .filter_map(|p| p.values.get(1)?.parse().ok())
            .collect()
    }
}

/// A node at the beginning of a text, and the rest.
fn node(text: &str, depth: usize) -> Option<(Node<'_>, &str)> {
    if depth > DEEPEST {
        return None;
    }
    let text = text.trim_start();
    let open = text.find(['[', '('])?;
    let keyword = text[..open].trim_end();
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if keyword.is_empty() || !keyword.chars().all(is_word) {
        return None;
    }
    let (mut values, mut children) = (Vec::new(), Vec::new());
    let mut rest = text[open + 1..].trim_start();
    loop {
        if let Some(quoted) = rest.strip_prefix('"') {
            let end = quoted.find('"')?;
            values.push(&quoted[..end]);
            rest = &quoted[end + 1..];
        } else {
            let end = rest.find([',', '[', '(', ']', ')'])?;
            if rest[end..].starts_with(['[', '(']) {
                let (child, after) = node(rest, depth + 1)?;
                children.push(child);
                rest = after;
            } else {
                values.push(rest[..end].trim());
                rest = &rest[end..];
            }
        }
        rest = rest.trim_start();
        if let Some(after) = rest.strip_prefix([']', ')']) {
            let text = &text[..text.len() - after.len()];
            let node = Node {
                keyword,
                values,
                children,
                text,
            };
            return Some((node, after));
        }
        rest = rest.strip_prefix(',')?.trim_start();
    }
}
