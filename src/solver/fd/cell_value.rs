//! Value of a quantity in a cell of a block.

use super::block::Block;
use super::quantity::Quantity;
use super::segment::Constants;
use crate::law::RowLaw;

/// Computes a quantity in all cells of a block, into `out`, with the same bits as [`cell_value`].
pub(super) fn block_values(
    quantity: Quantity,
    block: &Block,
    law: &dyn RowLaw,
    constants: &Constants,
    outer: [f64; 2],
    out: &mut [f64],
) {
    match quantity {
        Quantity::Stress => out.copy_from_slice(&block.sigma),
        Quantity::Strain if !block.is_plastic() => {
            // Adding 0 turns a negative zero into a positive one, as the plastic strain of 0 does in [`cell_value`].
            out.iter_mut().zip(&block.sigma[..]).for_each(|(out, sigma)| *out = (sigma + 0.0) / constants.modulus);
        }
        Quantity::Velocity if block.taper.is_none() => {
            let gain = constants.velocity_gain;
            let mut left = outer[0];
            let inner = block.sigma.windows(2).zip(&block.v[1..]);
            let right = inner.map(|(sigma, v)| v - 0.5 * (gain * (sigma[1] - sigma[0])));
            for (out, right) in out.iter_mut().zip(right.chain([outer[1]])) {
                *out = 0.5 * (left + right);
                left = right;
            }
        }
        _ => {
            for (i, out) in out.iter_mut().enumerate() {
                *out = cell_value(quantity, block, law, constants, outer, i);
            }
        }
    }
}

/// Returns a quantity in local cell `i` of a block; `outer` are the velocities of its two edge nodes at the time of the stresses, m/s.
#[inline]
pub(super) fn cell_value(
    quantity: Quantity,
    block: &Block,
    law: &dyn RowLaw,
    constants: &Constants,
    outer: [f64; 2],
    i: usize,
) -> f64 {
    let modulus = constants.modulus;
    match quantity {
        Quantity::Stress => block.sigma[i],
        Quantity::Strain => (block.sigma[i] + block.plastic_strain(law, i)) / modulus,
        Quantity::PlasticStrain => block.plastic_strain(law, i) / modulus,
        Quantity::AccumulatedPlasticStrain => block.accumulated(law, i) / modulus,
        Quantity::Temperature => law.temperature(&block.state, i),
        Quantity::Velocity => {
            let gain = constants.velocity_gain;
            let inner = |node: usize| block.v[node] - 0.5 * block.velocity_increment(gain, node);
            let left = if i == 0 { outer[0] } else { inner(i) };
            let right = if i + 1 == block.sigma.len() { outer[1] } else { inner(i + 1) };
            0.5 * (left + right)
        }
    }
}
