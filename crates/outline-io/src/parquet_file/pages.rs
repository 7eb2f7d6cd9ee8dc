//! The pages of a column, checked before anything is decoded.
use std::io::Read as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bytes::Bytes;
use parquet::basic::{Compression, Encoding, Type};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::ColumnDescriptor;

use crate::parquet_file::source::{PAGE_LIMIT, Source, damaged};

/// Most values of lists that are decoded at once, whatever the file says of its pages; an outline has fewer.
pub(crate) const VALUES_AT_ONCE: usize = 1 << 24;

/// Values of lists that may still be taken from pages before the reader of the column comes back.
#[derive(Debug, Clone, Default)]
pub(crate) struct Allowance(Arc<AtomicUsize>);

impl Allowance {
    /// Allows as many values as are decoded at once.
    pub(crate) fn renew(&self) {
        self.0.store(VALUES_AT_ONCE, Ordering::Relaxed);
    }

    fn take(&self, values: usize) -> Result<(), ParquetError> {
        match self.0.load(Ordering::Relaxed).checked_sub(values) {
            Some(left) => {
                self.0.store(left, Ordering::Relaxed);
                Ok(())
            }
            None => Err(damaged(format!("a list or a page of more than {VALUES_AT_ONCE} values"))),
        }
    }
}

/// Hands pages on after a look at what the decoders rely on. Pages without a value, at which they would stop, are left out.
pub(crate) struct CheckedPages {
    pages: SerializedPageReader<Source>,
    /// The next page, where that had to be known.
    ahead: Option<Page>,
    allowance: Allowance,
    /// Whether pages come compressed with zstd. The library would unpack them with a library in C, which takes as long to build as itself.
    is_zstd: bool,
    is_text: bool,
    /// Bytes of a number.
    width: usize,
    is_list: bool,
    has_levels: bool,
    has_dictionary: bool,
}

impl CheckedPages {
    pub(crate) fn open(
        source: &Arc<Source>,
        chunk: &ColumnChunkMetaData,
        column: &ColumnDescriptor,
        rows: usize,
        allowance: Allowance,
    ) -> Result<Self, ParquetError> {
        let offsets = [Some(chunk.data_page_offset()), chunk.dictionary_page_offset(), Some(chunk.compressed_size())];
        if offsets.into_iter().flatten().any(|offset| offset < 0) {
            return Err(damaged("a column at a negative place"));
        }
        if chunk.column_path().parts() != column.path().parts() || chunk.column_type() != column.physical_type() {
            return Err(damaged("a column that is not that of the schema"));
        }
        let is_text = column.physical_type() == Type::BYTE_ARRAY;
        let width = if matches!(column.physical_type(), Type::INT32 | Type::FLOAT) { 4 } else { 8 };
        let is_zstd = matches!(chunk.compression(), Compression::ZSTD(_));
        let as_it_is = |chunk: &ColumnChunkMetaData| {
            chunk.clone().into_builder().set_compression(Compression::UNCOMPRESSED).build()
        };
        let unpacked_here = is_zstd.then(|| as_it_is(chunk)).transpose()?;
        let pages = SerializedPageReader::new(Arc::clone(source), unpacked_here.as_ref().unwrap_or(chunk), rows, None)?;
        let (is_list, has_levels) = (column.max_rep_level() > 0, column.max_def_level() > 0);
        Ok(Self { pages, ahead: None, allowance, is_zstd, is_text, width, is_list, has_levels, has_dictionary: false })
    }

    fn read(&mut self) -> Result<Option<Page>, ParquetError> {
        while let Some(page) = self.pages.get_next_page()? {
            check_levels(&page)?;
            let page = if self.is_zstd { unpacked(page)? } else { page };
            self.check(&page)?;
            let page = match page.encoding() {
                Encoding::BYTE_STREAM_SPLIT if page.is_data_page() => self.joined(page)?,
                _ if self.is_text => with_end(page),
                _ => page,
            };
            if page.num_values() > 0 || page.is_dictionary_page() {
                return Ok(Some(page));
            }
        }
        Ok(None)
    }

    /// A page whose values are taken apart byte by byte, with plain values. The decoder of the library does not check its length.
    fn joined(&self, mut page: Page) -> Result<Page, ParquetError> {
        let start = self.levels_end(&page).ok_or_else(|| damaged("a page shorter than its levels"))?;
        if let Page::DataPage { buf, encoding, .. } | Page::DataPageV2 { buf, encoding, .. } = &mut page {
            let (levels, split) = buf.split_at(start);
            if split.len() % self.width != 0 {
                return Err(damaged(format!("{} bytes of values with {} each", split.len(), self.width)));
            }
            let values = split.len() / self.width;
            let mut bytes = levels.to_vec();
            bytes.extend((0..split.len()).map(|at| split[at % self.width * values + at / self.width]));
            *buf = Bytes::from(bytes);
            *encoding = Encoding::PLAIN;
        }
        Ok(page)
    }

    /// Where the levels of a page end; `None` where they are longer than the page.
    fn levels_end(&self, page: &Page) -> Option<usize> {
        let Page::DataPage { buf, .. } = page else { return Some(levels_length(page)) };
        let mut end = 0;
        for _ in 0..u8::from(self.is_list) + u8::from(self.has_levels) {
            let length = buf.get(end..end + 4)?.try_into().map(u32::from_le_bytes).ok()?;
            end += 4 + length as usize;
        }
        (end <= buf.len()).then_some(end)
    }

    fn check(&mut self, page: &Page) -> Result<(), ParquetError> {
        let (values, length) = (page.num_values() as usize, page.buffer().len());
        if page.is_dictionary_page() {
            // The smallest value has four bytes.
            if values > length / 4 {
                return Err(damaged(format!("a dictionary of {values} values in {length} bytes")));
            }
            self.has_dictionary = true;
            return Ok(());
        }
        match page.encoding() {
            Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY if !self.has_dictionary => {
                return Err(damaged("a page without its dictionary"));
            }
            Encoding::PLAIN | Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY => {}
            Encoding::BYTE_STREAM_SPLIT if !self.is_text => {}
            // The decoders of differences in the library can be brought down by damaged files.
            other => return Err(damaged(format!("values encoded as {other}, which is not read"))),
        }
        if let Page::DataPage { def_level_encoding, rep_level_encoding, .. } = page {
            let is_run_length = |encoding: &Encoding| *encoding == Encoding::RLE;
            if self.has_levels && !is_run_length(def_level_encoding)
                || self.is_list && !is_run_length(rep_level_encoding)
            {
                return Err(damaged(format!("levels encoded as {def_level_encoding}, which is not read")));
            }
        }
        if self.is_list { self.allowance.take(values) } else { Ok(()) }
    }
}

/// Refuses a page with longer levels than the page.
fn check_levels(page: &Page) -> Result<(), ParquetError> {
    let (length, levels) = (page.buffer().len(), levels_length(page));
    if levels > length {
        return Err(damaged(format!("levels of {levels} bytes in a page of {length}")));
    }
    Ok(())
}

/// Bytes of the levels in front of the values, in pages that state it.
fn levels_length(page: &Page) -> usize {
    match page {
        Page::DataPageV2 { def_levels_byte_len, rep_levels_byte_len, .. } => {
            *def_levels_byte_len as usize + *rep_levels_byte_len as usize
        }
        Page::DataPage { .. } | Page::DictionaryPage { .. } => 0,
    }
}

/// Text with an end that reads as a length beyond the page: of a page that ends too soon the decoder says so then, instead of reading on.
fn with_end(mut page: Page) -> Page {
    match &mut page {
        Page::DataPage { buf, encoding: Encoding::PLAIN, .. }
        | Page::DataPageV2 { buf, encoding: Encoding::PLAIN, .. }
        | Page::DictionaryPage { buf, .. } => *buf = Bytes::from([&buf[..], &[0xff; 4]].concat()),
        Page::DataPage { .. } | Page::DataPageV2 { .. } => {}
    }
    page
}

/// A page compressed with zstd, but for the levels of pages of the second version.
fn unpacked(mut page: Page) -> Result<Page, ParquetError> {
    let levels = levels_length(&page);
    match &mut page {
        Page::DataPageV2 { is_compressed: false, .. } => {}
        Page::DataPage { buf, .. } | Page::DataPageV2 { buf, .. } | Page::DictionaryPage { buf, .. } => {
            let mut bytes = buf[..levels].to_vec();
            let compressed = &buf[levels..];
            if !compressed.is_empty() {
                let failed = |error: &dyn std::fmt::Display| damaged(format!("zstd: {error}"));
                let decoder = ruzstd::decoding::StreamingDecoder::new(compressed).map_err(|error| failed(&error))?;
                decoder.take(PAGE_LIMIT + 1).read_to_end(&mut bytes).map_err(|error| failed(&error))?;
            }
            if bytes.len() as u64 > PAGE_LIMIT {
                return Err(damaged(format!("a page of more than {PAGE_LIMIT} bytes")));
            }
            *buf = Bytes::from(bytes);
        }
    }
    Ok(page)
}

impl Iterator for CheckedPages {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for CheckedPages {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        match self.ahead.take() {
            Some(page) => Ok(Some(page)),
            None => self.read(),
        }
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        Err(damaged("pages are not skipped"))
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        Err(damaged("pages are not skipped"))
    }

    fn at_record_boundary(&mut self) -> Result<bool, ParquetError> {
        if self.ahead.is_none() {
            self.ahead = self.read()?;
        }
        // Pages of the second version begin with a row.
        Ok(!matches!(self.ahead, Some(Page::DataPage { .. } | Page::DictionaryPage { .. })))
    }
}
