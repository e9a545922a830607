//! stub
use super::*;
/// stub
#[derive(Debug)]
pub struct ReportError;
/// stub
pub fn write_report() {}
/// stub
pub fn write_comparison_report() {}
