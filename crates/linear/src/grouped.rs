//! Members gathered by their groups.

/// The start of each of `count` groups among all members, and the number of members at the end, from the group of each
/// member.
pub fn group_starts(count: usize, groups: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0; count + 1];
    groups.for_each(|group| starts[group + 1] += 1);
    (0..count).for_each(|group| starts[group + 1] += starts[group]);
    starts
}

/// The start of each of `count` groups, and the members of one group after another, each in increasing order.
pub fn grouped(count: usize, of_member: &[u32]) -> (Vec<usize>, Vec<usize>) {
    let starts = group_starts(count, of_member.iter().map(|&group| group as usize));
    let mut next = starts.clone();
    let mut members = vec![0; of_member.len()];
    for (member, &group) in of_member.iter().enumerate() {
        members[next[group as usize]] = member;
        next[group as usize] += 1;
    }
    (starts, members)
}
