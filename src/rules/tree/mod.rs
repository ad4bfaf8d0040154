//! TREE: the structure of the frame tree.

pub mod orphan_subtree;
