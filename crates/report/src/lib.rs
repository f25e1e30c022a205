//! `report.html`: one page about a result that needs no other file and no network.
//!
//! - [`frames`] reads the particles of a result at its times from VTKHDF files.
//! - [`payload`] reduces the frames to arrays of a bounded size.
//! - [`page`] joins the arrays, the summary and the pictures with the viewer to a page. The viewer
//!   (`page/report.js`) draws with uPlot (`page/uplot`, MIT licence).
//!
//! The crate is independent of scenes, materials and the solver. Arrays, units and names come from the
//! files of the result.

pub mod error;
pub mod frames;
pub mod page;
pub mod payload;

pub use error::ReportError;
pub use frames::{Column, Frame, FrameFile};
pub use page::{Body, Curve, LARGEST_PAGE, Page};
