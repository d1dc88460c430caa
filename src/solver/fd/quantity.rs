//! Quantities that can be read from a bar.

/// Quantity in a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Engineering stress, Pa, tension positive.
    Stress,
    /// Engineering strain.
    Strain,
    /// Velocity at the centre at the time of the stresses, m/s, positive in +x: the mean over the cell's two nodes
    /// and over the half steps before and after.
    Velocity,
    /// Signed plastic strain.
    PlasticStrain,
    /// Accumulated plastic strain, >= 0.
    AccumulatedPlasticStrain,
    /// Temperature, K; NaN without the effect of heat.
    Temperature,
}
