//! The two free motions of a damped oscillator, underdamped or overdamped.

/// Returns `e^(-delta t) cos(nu t)` and `e^(-delta t) sin(nu t)/nu` with `nu^2 = omega^2 - delta^2`; above critical damping cosh and sinh.
pub(super) fn decay(omega: f64, delta: f64, t: f64) -> [f64; 2] {
    let nu2 = (omega - delta) * (omega + delta);
    let x = nu2 * t * t;
    if x.abs() < 1e-3 {
        let cosine = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0));
        let sine = t * (1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0)));
        return [cosine, sine].map(|value| value * (-delta * t).exp());
    }
    let nu = nu2.abs().sqrt();
    if nu2 > 0.0 {
        let (sine, cosine) = (nu * t).sin_cos();
        return [cosine, sine / nu].map(|value| value * (-delta * t).exp());
    }
    let (slow, fast) = ((-omega * omega / (delta + nu) * t).exp(), (-(delta + nu) * t).exp());
    [0.5 * (slow + fast), 0.5 * (slow - fast) / nu]
}
