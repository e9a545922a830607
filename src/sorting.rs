//! The one sorting routine: the standard library's is compiled anew for every type of list, at 5 to 9 kB of the wasm.

/// The places of these keys from the least to the greatest, as [`f64::total_cmp`] has it; equal ones keep their order.
pub(crate) fn order(keys: impl Iterator<Item = f64>) -> Vec<usize> {
    let mut list: Vec<(u64, usize)> = keys.enumerate().map(|(place, key)| (rank(key), place)).collect();
    sort(&mut list);
    list.into_iter().map(|(_, place)| place).collect()
}

/// Sorts numbers from the least to the greatest, as [`f64::total_cmp`] has it.
pub(crate) fn ascending(values: &mut Vec<f64>) {
    *values = order(values.iter().copied()).into_iter().map(|place| values[place]).collect();
}

/// No two elements are equal, so there is only one order, stable or not.
#[inline(never)]
fn sort(list: &mut [(u64, usize)]) {
    list.sort_unstable();
}

/// An integer that is to others as the number is to others: negative ones, whose bits grow downwards, are turned round.
fn rank(key: f64) -> u64 {
    let bits = key.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_a_stable_sort() {
        let keys = [3.0, -0.0, f64::NAN, 0.0, -f64::INFINITY, 3.0, 1e-310, -2.5, f64::INFINITY, -0.0, -1e300, 3.0];
        let mut expected: Vec<usize> = (0..keys.len()).collect();
        expected.sort_by(|&a, &b| keys[a].total_cmp(&keys[b]));
        assert_eq!(order(keys.into_iter()), expected);
        let (mut ours, mut theirs) = (keys.to_vec(), keys.to_vec());
        ascending(&mut ours);
        theirs.sort_by(f64::total_cmp);
        let bits = |list: &[f64]| list.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&ours), bits(&theirs));
    }
}
