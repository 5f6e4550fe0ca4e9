//! Settings of a scene's motion.

use super::array::vector;
use super::file::{DampingFile, IntegratorName, LinearName, NewtonName, SolverFile, WindFile};
use cloth_data::error::Result;
use cloth_data::io::TomlFile;
use cloth_sim::dynamics::{Damping, Integrator, LinearSolver, Newton, Settings, Wind};

/// γ of conjugate gradients, as published.
const LINEAR_TOLERANCE: f64 = 1e-5;

/// Maximum iterations of one linear system.
const LINEAR_ITERATIONS: usize = 1000;

/// Settings described by the file.
pub(super) fn settings(
    step: f64,
    solver: &SolverFile,
    damping: &DampingFile,
    wind: Option<&WindFile>,
    file: &TomlFile,
) -> Result<Settings> {
    for (key, value) in
        [("damping.mass_per_s", damping.mass_per_s), ("damping.stiffness_s", damping.stiffness_s)]
    {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(file.invalid(key, value.to_string(), "0 or more"));
        }
    }
    let damping = Damping { mass: damping.mass_per_s, stiffness: damping.stiffness_s };
    let wind = wind.map(|wind| of_wind(wind, file)).transpose()?;
    Ok(Settings { step, integrator: integrator(solver, file)?, damping, wind })
}

fn integrator(solver: &SolverFile, file: &TomlFile) -> Result<Integrator> {
    let SolverFile { integrator, newton, tolerance, linear, linear_tolerance, linear_iterations } = *solver;
    // A key without effect is an error.
    let idle = |keys: &[(&str, bool)], why: &str| match keys.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(file.invalid(&format!("solver.{key}"), "a value that nothing uses", why)),
        None => Ok(()),
    };
    let linear_keys = [
        ("linear_tolerance", linear_tolerance.is_some()),
        ("linear_iterations", linear_iterations.is_some()),
    ];
    if integrator == IntegratorName::RungeKutta {
        let keys =
            [("newton", newton.is_some()), ("tolerance", tolerance.is_some()), ("linear", linear.is_some())];
        idle(&keys, "integrator = \"implicit-euler\"")?;
        idle(&linear_keys, "integrator = \"implicit-euler\"")?;
        return Ok(Integrator::RungeKutta);
    }
    let positive = |key: &str, value: f64| match value > 0.0 && value < 1.0 {
        true => Ok(value),
        false => Err(file.invalid(key, value.to_string(), "a share between 0 and 1")),
    };
    let newton = match newton.unwrap_or(NewtonName::Converged) {
        NewtonName::Converged => match tolerance {
            Some(tolerance) => Newton::Converged { tolerance: positive("solver.tolerance", tolerance)? },
            None => Newton::default(),
        },
        NewtonName::Single => {
            idle(&[("tolerance", tolerance.is_some())], "newton = \"converged\"")?;
            Newton::Single
        }
    };
    let linear = match linear.unwrap_or(LinearName::Direct) {
        LinearName::Direct => {
            idle(&linear_keys, "linear = \"conjugate-gradient\"")?;
            LinearSolver::Direct
        }
        LinearName::ConjugateGradient => {
            let tolerance = linear_tolerance.unwrap_or(LINEAR_TOLERANCE);
            let max_iterations = linear_iterations.unwrap_or(LINEAR_ITERATIONS);
            if max_iterations == 0 {
                return Err(file.invalid("solver.linear_iterations", "0", "1 or more"));
            }
            let tolerance = positive("solver.linear_tolerance", tolerance)?;
            LinearSolver::ConjugateGradient { tolerance, max_iterations }
        }
    };
    Ok(Integrator::ImplicitEuler { newton, linear })
}

fn of_wind(wind: &WindFile, file: &TomlFile) -> Result<Wind> {
    let still = Wind::default();
    if wind.gust_m_s.is_some() != wind.gust_period_s.is_some() {
        let expected = "gust_m_s and gust_period_s together";
        return Err(file.invalid("wind", "one of gust_m_s and gust_period_s", expected));
    }
    let not_negative = |key: &str, value: Option<f64>, default: f64| match value.unwrap_or(default) {
        value if value >= 0.0 && value.is_finite() => Ok(value),
        value => Err(file.invalid(key, value.to_string(), "0 or more")),
    };
    let gust_period = wind.gust_period_s.unwrap_or(still.gust_period);
    if !(gust_period > 0.0 && gust_period.is_finite()) {
        return Err(file.invalid("wind.gust_period_s", gust_period.to_string(), "a number above 0"));
    }
    Ok(Wind {
        velocity: vector(file, "wind.velocity_m_s", wind.velocity_m_s)?,
        gust: vector(file, "wind.gust_m_s", wind.gust_m_s.unwrap_or_default())?,
        gust_period,
        density: not_negative("wind.air_density_kg_m3", wind.air_density_kg_m3, still.density)?,
        normal_drag: not_negative("wind.normal_drag", wind.normal_drag, still.normal_drag)?,
        tangential_drag: not_negative("wind.tangential_drag", wind.tangential_drag, still.tangential_drag)?,
    })
}
