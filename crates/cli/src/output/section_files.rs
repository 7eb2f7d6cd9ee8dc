use std::path::Path;

use freeform_drawing::Svg;
use freeform_drawing::page::{Drawing, Table};
use freeform_experiments::paper::Section;

use super::file::WholeFile;
use crate::failure::Failure;

/// Writes the figures of a section and the numbers behind its figures and tables into a folder.
pub(crate) fn write_section_files(section: &Section, folder: &Path) -> Result<(), Failure> {
    for Drawing { name, figure, data, .. } in &section.drawings {
        WholeFile::write(&folder.join(format!("{name}.svg")), &Svg(figure).file())?;
        WholeFile::write(&folder.join(format!("{name}.csv")), &table_csv(data)?)?;
    }
    for table in &section.tables {
        WholeFile::write(&folder.join(format!("{}.csv", table.name)), &table_csv(table)?)?;
    }
    Ok(())
}

fn table_csv(table: &Table) -> Result<String, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut rows = std::iter::once(&table.heads).chain(&table.rows);
    rows.try_for_each(|row| writer.write_record(row)).map_err(Failure::unusable)?;
    let bytes = writer.into_inner().map_err(Failure::unusable)?;
    String::from_utf8(bytes).map_err(Failure::unusable)
}
