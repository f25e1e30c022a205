//! The page: the viewer with the data of one result.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::Value;

use crate::error::ReportError;
use crate::payload::Payload;

/// First line of a report, by which an earlier one is known.
pub const FIRST_LINE: &str = "<!DOCTYPE html><!-- report of flyer-mpm -->";

/// Greatest size of a page [bytes].
pub const LARGEST_PAGE: usize = 5_000_000;

/// Greatest size of all pictures in the page [bytes].
const LARGEST_PICTURES: u64 = 1_000_000;

/// Longest text of the scene, and of the rest of the summary [characters].
const LONGEST_TEXT: usize = 200_000;

/// Longest list of numbers of a scene that is shown in full.
const LONGEST_LIST: usize = 64;

/// The plotting library; its licence is in `page/uplot/LICENSE`.
const UPLOT: &str = include_str!("../page/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../page/uplot/uPlot.min.css");
const UPLOT_LICENSE: &str = include_str!("../page/uplot/LICENSE");
/// Version of the plotting library, as in `page/uplot/README.md`.
pub const UPLOT_VERSION: &str = "1.6.32";

const VIEWER: &str = include_str!("../page/report.js");
const STYLE: &str = include_str!("../page/report.css");
const BODY: &str = include_str!("../page/report.html");

/// A body of the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name of the body.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Colour of its material, as `#rrggbb`.
    pub color: String,
}

/// An exact curve over the position on a line.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Curve {
    /// Time \[s\].
    pub time: f64,
    /// Positions \[m\].
    pub x: Vec<f64>,
    /// Values by name of the quantity, in SI units.
    pub values: BTreeMap<String, Vec<f64>>,
}

/// A table with named columns of numbers.
pub type Columns = BTreeMap<String, Vec<Option<f64>>>;

/// Data of a page.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Page {
    /// `summary.json` of the result, with its scene.
    pub summary: Value,
    /// Bodies of the scene, in its order.
    pub bodies: Vec<Body>,
    /// Frames of the particles.
    pub frames: Payload,
    /// Exact curves.
    pub exact: Vec<Curve>,
    /// Histories; empty without any.
    pub histories: Columns,
    /// Pictures: name and address of data.
    pub pictures: Vec<(String, String)>,
}

impl Page {
    /// Adds those pictures of a folder that the frames do not show.
    ///
    /// # Errors
    ///
    /// If a picture cannot be read.
    pub fn add_pictures(&mut self, folder: &Path) -> Result<(), ReportError> {
        let unreadable = |doing, path: &Path| {
            let path = path.to_path_buf();
            move |source| ReportError::Io { doing, path, source }
        };
        let entries = fs::read_dir(folder).map_err(unreadable("read the folder", folder))?;
        let mut paths: Vec<_> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
        paths.retain(|path| path.extension().is_some_and(|end| end == "png"));
        // diagrams first, then the latest of each kind
        paths.sort();
        paths.reverse();
        paths.sort_by_key(|path| !path.ends_with("x_t_diagram.png"));
        let mut size = 0;
        for path in paths {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let length = fs::metadata(&path).map_or(u64::MAX, |data| data.len());
            if size + length > LARGEST_PICTURES {
                continue;
            }
            size += length;
            let bytes = fs::read(&path).map_err(unreadable("read the picture", &path))?;
            self.pictures.push((name, format!("data:image/png;base64,{}", STANDARD.encode(bytes))));
        }
        Ok(())
    }

    /// Drops the histories, then the frames; returns whether there were any.
    fn drop_arrays(&mut self) -> bool {
        if !self.histories.is_empty() {
            self.histories.clear();
            return true;
        }
        !std::mem::take(&mut self.frames).is_empty()
    }

    /// The text of the page, of at most [`LARGEST_PAGE`] bytes.
    #[expect(clippy::missing_panics_doc, reason = "the data are plain")]
    pub fn html(mut self) -> String {
        shorten(&mut self.summary);
        if self.summary.to_string().len() > LONGEST_TEXT {
            self.summary["scene"] = Value::from("too long for this page; see summary.json");
        }
        let title = self.summary["title"].as_str().unwrap_or("flyer-mpm").to_owned();
        loop {
            let data = serde_json::to_string(&self).expect("plain data");
            // no end of the script, and no comment, within the data
            let data = data.replace('<', "\\u003c");
            let page = [
                FIRST_LINE,
                "\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n",
                "<meta name=\"viewport\" content=\"width=device-width\">\n",
                // nothing is loaded from anywhere
                "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; ",
                "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n",
                &format!("<title>{}</title>\n<style>\n", escaped(&title)),
                UPLOT_STYLE,
                "\n",
                STYLE,
                "</style></head>\n",
                BODY,
                "<script>\n",
                &format!("/* uPlot {UPLOT_VERSION}\n{UPLOT_LICENSE}*/\n"),
                UPLOT,
                "\n</script>\n<script type=\"application/json\" id=\"data\">",
                &data,
                "</script>\n<script>\n",
                VIEWER,
                "</script>\n</html>\n",
            ]
            .concat();
            // the least needed goes first
            let fits = page.len() <= LARGEST_PAGE;
            if fits || !(self.pictures.pop().is_some() || self.drop_arrays()) {
                return page;
            }
        }
    }
}

/// Replaces long lists of numbers by their length.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(items) if items.len() > LONGEST_LIST && items.iter().all(is_numeric) => {
            *value = Value::from(format!("{} entries", items.len()));
        }
        Value::Array(items) => items.iter_mut().for_each(shorten),
        Value::Object(map) => map.values_mut().for_each(shorten),
        _ => {}
    }
}

/// Whether a value is a number or a list of numbers.
fn is_numeric(value: &Value) -> bool {
    value.is_number() || value.as_array().is_some_and(|items| items.iter().all(Value::is_number))
}

/// Text within HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn data_cannot_end_the_script() {
        let summary = json!({"title": "a </script><b>", "scene": {"points": vec![0.5; 1000]}});
        let page = Page { summary, ..Page::default() }.html();
        assert!(page.starts_with(FIRST_LINE));
        assert_eq!(page.matches("</script>").count(), 3);
        assert!(page.contains("<title>a &lt;/script&gt;&lt;b&gt;</title>"));
        assert!(page.contains("1000 entries") && !page.contains("0.5,0.5"));
        assert!(page.contains(&format!("uPlot (v{UPLOT_VERSION})")), "the version of the file");
        assert!(page.contains("The MIT License"));
    }

    #[test]
    fn a_page_is_never_larger_than_its_limit() {
        let pictures = (0..8).map(|k| (format!("{k}"), "x".repeat(1_000_000))).collect();
        let page = Page { pictures, ..Page::default() }.html();
        assert!(page.len() <= LARGEST_PAGE && page.len() > 3_000_000);
    }
}
