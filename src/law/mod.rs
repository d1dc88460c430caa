//! Material laws for the solvers: state and strain increment in, stress out.
