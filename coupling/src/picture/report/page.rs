//! The page: its frame, and what stands in it.

use serde_json::Value;

use super::Blob;
use super::table::Table;
use crate::files::vtk::escape;

const SCRIPT: &str = include_str!("viewer.js");
const STYLE: &str = include_str!("viewer.css");

/// Columns of a table that may stand beside another one.
const MOST_COLUMNS_BESIDE: usize = 6;

/// Rows of a table that are shown without scrolling.
const MOST_ROWS: usize = 16;

/// What a page shows.
pub(super) struct Contents<'a> {
    pub title: &'a str,
    /// `None` while the run is under way.
    pub verdict: Option<[String; 3]>,
    pub description: &'a str,
    pub tables: &'a [Table],
    /// Pictures; empty if there are none.
    pub maps: &'a str,
    /// SVG; empty if there is none.
    pub overview: &'a str,
    /// The scene as run.
    pub scene: &'a str,
    /// For the script.
    pub meta: &'a Value,
    pub blobs: &'a [Blob],
}

/// The file.
pub(super) fn page(contents: &Contents<'_>) -> String {
    let title = escape(contents.title);
    let (verdict, description) = (
        verdict(contents.verdict.as_ref()),
        escape(contents.description),
    );
    let tables: String = contents.tables.iter().map(table).collect();
    // an end tag in a string would end the script
    let meta = contents.meta.to_string().replace("</", "<\\/");
    let blobs: String = (contents.blobs.iter())
        .map(|Blob { id, text }| {
            format!(
                "<script type=\"application/octet-stream;base64\" id=\"{id}\">{text}</script>\n"
            )
        })
        .collect();
    let overview = match contents.overview.find("<svg") {
        Some(start) => format!(
            "<h2>Overview</h2>\n<div id=\"overview\">{}</div>",
            &contents.overview[start..]
        ),
        None => String::new(),
    };
    let (scene, maps) = (escape(contents.scene), contents.maps);
    format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{STYLE}</style>
</head>
<body>
<header><h1>{title}</h1></header>
{verdict}
<main>
<section id="player" aria-label="playback">
<canvas id="canvas" tabindex="0" role="img" aria-label="the run at the time of the slider"></canvas>
<div id="legend"><div id="ramp"></div><div><span id="from"></span><span id="to"></span></div></div>
<div class="bar">
<button id="play" aria-label="play">▶</button>
<div class="slide"><input id="time" type="range" min="0" max="1" value="0" aria-label="time"><div id="marks"></div></div>
<span id="clock"></span>
</div>
<div class="bar">
<select id="pace" aria-label="pace"><option value="0.1">1/10 of real time</option><option value="0.25">1/4</option><option value="1" selected>real time</option><option value="4">4 times</option><option value="16">16 times</option></select>
<button id="orbit" aria-pressed="false">space</button><button id="top" aria-pressed="false">from above</button><button id="section" aria-pressed="false">from the side</button>
<span id="colors" hidden><select id="color" aria-label="color of the water"><option value="elevation">color: elevation</option><option value="speed">color: speed</option></select></span>
<span class="soft keys">space: play; arrows: frames; 1, 2, 3: views; drag, wheel</span>
</div>
<div id="events"></div>
</section>
<p id="fault" role="alert"></p>
<p class="soft">Shown: {description}. Blocks are drawn rigid.</p>
<div id="stills"></div>
<section id="gauges"><h2>Gauges</h2><div class="bar"><select id="gauge" aria-label="gauge"></select></div><div id="chart"></div></section>
{maps}<div class="tables">
{tables}</div>
{overview}
<details><summary>The scene as run, case.ron</summary><pre>{scene}</pre></details>
</main>
<noscript><p>Playback needs JavaScript; pictures and tables do not.</p></noscript>
<script type="application/json" id="meta">{meta}</script>
{blobs}<script>
{SCRIPT}</script>
</body>
</html>
"#
    )
}

fn verdict(lines: Option<&[String; 3]>) -> String {
    let Some(lines) = lines else {
        return "<div id=\"verdict\" class=\"fair\"><p>The run is under way, or was lost before its end.</p></div>".to_owned();
    };
    let class = ["poor", "fair"]
        .into_iter()
        .find(|grade| lines[0].contains(&format!(": {grade}")));
    let lines: String = lines
        .iter()
        .map(|line| match line.split_once(": ") {
            Some((about, rest)) => format!("<p><b>{}: </b>{}</p>", escape(about), escape(rest)),
            None => format!("<p>{}</p>", escape(line)),
        })
        .collect();
    format!(
        "<div id=\"verdict\" class=\"{}\">{lines}</div>",
        class.unwrap_or("good")
    )
}

fn table(table: &Table) -> String {
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
        let cells: String = cells
            .map(|cell| format!("<{tag}>{}</{tag}>", escape(cell)))
            .collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = (table.rows.iter())
        .map(|row| cells("td", &mut row.iter().map(String::as_str)))
        .collect();
    let head = match table.head.iter().all(|cell| cell.is_empty()) {
        true => String::new(),
        false => cells("th", &mut table.head.iter().map(String::as_str)),
    };
    let note = match table.note.is_empty() {
        true => String::new(),
        false => format!("<p class=\"soft\">{}</p>", escape(&table.note)),
    };
    let class = if MOST_COLUMNS_BESIDE < table.head.len() {
        " class=\"whole\""
    } else {
        ""
    };
    let long = if MOST_ROWS < table.rows.len() {
        " long"
    } else {
        ""
    };
    format!(
        "<section{class}><h2>{}</h2>\n<div class=\"wide{long}\" tabindex=\"0\"><table>\n{head}{rows}</table></div>{note}</section>\n",
        table.title
    )
}
