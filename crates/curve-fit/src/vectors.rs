use pulp::Simd;

/// Fills vectors with consecutive values, the last of them with 0 where there are no more; returns the vectors that hold a value.
///
/// # Panics
/// If there are more values than the vectors hold.
#[inline(always)]
pub(crate) fn load<'a, S: Simd>(simd: S, values: &[f64], vectors: &'a mut [S::f64s]) -> &'a [S::f64s] {
    let (full, rest) = S::as_simd_f64s(values);
    let mut count = full.len();
    vectors[..count].copy_from_slice(full);
    if !rest.is_empty() {
        vectors[count] = simd.partial_load_f64s(rest);
        count += 1;
    }
    &vectors[..count]
}

/// Sum of `term` over the values, in eight interleaved partial sums that the compiler can keep in vector registers.
#[inline(always)]
pub(crate) fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let (chunks, rest) = values.as_chunks::<8>();
    let mut partial = [0.0; 8];
    for chunk in chunks {
        partial.iter_mut().zip(chunk).for_each(|(sum, &value)| *sum += term(value));
    }
    partial.iter().sum::<f64>() + rest.iter().map(|&value| term(value)).sum::<f64>()
}

/// Makes room for so many values in all, with some to spare where there was not enough, so that outlines of about the same number
/// of points need no more after the first.
pub(crate) fn reserve<T>(buffer: &mut Vec<T>, count: usize) {
    if buffer.capacity() < count {
        buffer.reserve(count + count / 4 - buffer.len());
    }
}
