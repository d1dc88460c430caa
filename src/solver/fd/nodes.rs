//! Read access to the nodes between blocks and at the ends of the bar.

use super::contact::Contact;
use super::edge::Edge;
use super::end_node::EndNode;

/// Nodes at the edges of neighbouring blocks, for reading.
#[derive(Clone, Copy)]
pub(super) struct Nodes<'a> {
    /// Number of the first block.
    pub first: usize,
    /// Nodes between the blocks.
    pub edges: &'a [Edge],
    /// Joints that can open among them.
    pub contacts: &'a [Contact],
    /// Nodes at the ends of the bar, if the blocks include them.
    pub ends: [Option<&'a EndNode>; 2],
}

impl Nodes<'_> {
    /// Returns the velocities (m/s), at the time of the stresses, of the nodes at the left and right edge of block `k`, counted from the
    /// first; NaN if the blocks do not include the node.
    pub fn edge_velocities(self, k: usize) -> [f64; 2] {
        let end_node = |end: Option<&EndNode>| end.map_or(f64::NAN, EndNode::velocity);
        [0, 1].map(|side| match k + side {
            0 => end_node(self.ends[0]),
            edge if edge > self.edges.len() => end_node(self.ends[1]),
            edge => {
                let contact = self.contacts.iter().find(|contact| contact.edge + 1 == self.first + edge);
                contact.map_or_else(|| self.edges[edge - 1].velocity(), |contact| contact.velocity(1 - side))
            }
        })
    }
}
