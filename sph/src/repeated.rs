//! Columns whose entries repeat, as they are saved: each run of equal entries once, with its length.

use serde::de::DeserializeOwned;
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) fn serialize<T, S>(column: &[T], serializer: S) -> Result<S::Ok, S::Error>
where
    T: PartialEq + Serialize,
    S: Serializer,
{
    let runs = || column.chunk_by(|a, b| a == b);
    let mut out = serializer.serialize_seq(Some(runs().count()))?;
    for run in runs() {
        out.serialize_element(&(run.len() as u32, &run[0]))?;
    }
    out.end()
}

pub(crate) fn deserialize<'a, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    T: Clone + DeserializeOwned,
    D: Deserializer<'a>,
{
    let runs = Vec::<(u32, T)>::deserialize(deserializer)?;
    let mut column = Vec::with_capacity(runs.iter().map(|(n, _)| *n as usize).sum());
    for (n, entry) in runs {
        column.resize(column.len() + n as usize, entry);
    }
    Ok(column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Saved(#[serde(with = "super")] Vec<f64>);

    #[test]
    fn runs_are_read_as_they_were_written() -> Result<(), postcard::Error> {
        let columns = [
            vec![],
            vec![0.1],
            vec![0.1; 1000],
            vec![0.1, 0.1, 0.2, 0.1, 0.3, 0.3],
        ];
        // a length, and nine bytes for a run of up to 127
        let sizes = [1, 10, 11, 37];
        for (column, size) in columns.into_iter().zip(sizes) {
            let saved = Saved(column);
            let bytes = postcard::to_extend(&saved, Vec::new())?;
            assert_eq!(bytes.len(), size, "{saved:?}");
            assert_eq!(postcard::from_bytes::<Saved>(&bytes)?, saved);
        }
        Ok(())
    }
}
