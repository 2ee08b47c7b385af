//! Convex quadratic programmes with small linear matrix inequalities, as second-order cones for clarabel.
//!
//! A symmetric 2x2 matrix is positive semidefinite exactly where (a + b, a - b, 2c) is in the second-order cone. A 3x3
//! one is written T'MT = sum of three 2x2 blocks, each positive semidefinite (scaled diagonal dominance): enough, not
//! necessary. With T adapted to a previous solution (T'MT near the identity) little is lost, and every
//! solution stays feasible for the real inequality.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::SMatrix;

/// A number that depends on the variables: sum of coefficient times variable, and a constant.
#[derive(Debug, Clone, Default)]
pub struct Affine {
    terms: Vec<(usize, f64)>,
    constant: f64,
}

impl Affine {
    pub fn constant(constant: f64) -> Self {
        Self { terms: vec![], constant }
    }

    pub fn variable(index: usize) -> Self {
        Self { terms: vec![(index, 1.0)], constant: 0.0 }
    }

    /// self += factor * other
    pub fn add(&mut self, other: &Self, factor: f64) {
        if factor != 0.0 {
            self.terms.extend(other.terms.iter().map(|t| (t.0, t.1 * factor)));
            self.constant += other.constant * factor;
        }
    }

    fn plus(&self, other: &Self, factor: f64) -> Self {
        let mut sum = self.clone();
        sum.add(other, factor);
        sum
    }
}

/// A symmetric matrix whose entries depend on the variables.
pub type AffineMatrix<const D: usize> = [[Affine; D]; D];

/// Minimise 1/2 x'Hx + q'x subject to cones.
pub struct Programme {
    variables: usize,
    entries: Vec<(usize, usize, f64)>,
    constants: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Programme {
    pub fn new(variables: usize) -> Self {
        Self { variables, entries: vec![], constants: vec![], cones: vec![] }
    }

    fn new_variable(&mut self) -> Affine {
        self.variables += 1;
        Affine::variable(self.variables - 1)
    }

    /// Clarabel's form is Ax + s = b with s in the cone; so s = value needs A = -terms.
    fn row(&mut self, mut value: Affine) {
        let row = self.constants.len();
        value.terms.sort_by_key(|t| t.0);
        for chunk in value.terms.chunk_by(|a, b| a.0 == b.0) {
            let sum: f64 = chunk.iter().map(|t| t.1).sum();
            if sum != 0.0 {
                self.entries.push((row, chunk[0].0, -sum));
            }
        }
        self.constants.push(value.constant);
    }

    /// [a c; c b] >= 0
    fn semidefinite_2(&mut self, a: &Affine, b: &Affine, c: &Affine) {
        self.row(a.plus(b, 1.0));
        self.row(a.plus(b, -1.0));
        self.row(Affine::default().plus(c, 2.0));
        self.cones.push(SupportedConeT::SecondOrderConeT(3));
    }

    /// M >= 0, exactly for D = 2; for D = 3 by the sufficient condition in the basis T.
    pub fn semidefinite<const D: usize>(&mut self, m: &AffineMatrix<D>, basis: &SMatrix<f64, D, D>) {
        if D == 2 {
            return self.semidefinite_2(&m[0][0], &m[1][1], &m[0][1]);
        }
        let entry = |r: usize, c: usize| {
            let mut sum = Affine::default();
            for i in 0..D {
                for j in 0..D {
                    sum.add(&m[i][j], basis[(i, r)] * basis[(j, c)]);
                }
            }
            sum
        };
        // Each diagonal entry is shared between the D - 1 blocks it is in; the last block takes what is left.
        let mut left: Vec<Affine> = (0..D).map(|i| entry(i, i)).collect();
        let mut uses = vec![D - 1; D];
        for r in 0..D {
            for c in r + 1..D {
                let mut share = |i: usize| {
                    uses[i] -= 1;
                    if uses[i] == 0 {
                        return left[i].clone();
                    }
                    let part = self.new_variable();
                    left[i].add(&part, -1.0);
                    part
                };
                let (a, b) = (share(r), share(c));
                self.semidefinite_2(&a, &b, &entry(r, c));
            }
        }
    }

    /// Solves with the upper triangle of H as triplets. What the solver says where there is no solution is the error.
    pub fn solve(mut self, hessian: &[(usize, usize, f64)], linear: &[f64]) -> Result<Vec<f64>, String> {
        let n = self.variables;
        let mut q = linear.to_vec();
        q.resize(n, 0.0);
        self.entries.retain(|e| e.2 != 0.0);
        let sparse = |rows, entries: &[(usize, usize, f64)]| {
            CscMatrix::new_from_triplets(
                rows,
                n,
                entries.iter().map(|e| e.0).collect(),
                entries.iter().map(|e| e.1).collect(),
                entries.iter().map(|e| e.2).collect(),
            )
        };
        let (h, a) = (sparse(n, hessian), sparse(self.constants.len(), &self.entries));
        let settings = DefaultSettings { verbose: false, ..Default::default() };
        let mut solver =
            DefaultSolver::new(&h, &q, &a, &self.constants, &self.cones, settings).map_err(|e| e.to_string())?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(solver.solution.x),
            other => Err(format!("the solver ended with {other:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    /// The nearest positive semidefinite matrix has the negative eigenvalues cut off; SDD comes close from inside.
    #[test]
    fn three_by_three_is_inside_and_close_once_the_basis_fits() {
        let target = Matrix3::new(1.0, 2.0, 0.5, 2.0, 1.0, -1.0, 0.5, -1.0, 2.0);
        let eigen = target.symmetric_eigen();
        let best = eigen.eigenvectors
            * Matrix3::from_diagonal(&eigen.eigenvalues.map(|l: f64| l.max(0.0)))
            * eigen.eigenvectors.transpose();
        let index = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
        let mut basis = Matrix3::identity();
        let mut last = f64::MAX;
        for _ in 0..6 {
            let mut programme = Programme::new(6);
            let m = index.map(|row| row.map(Affine::variable));
            programme.semidefinite::<3>(&m, &basis);
            let weight = |r: usize, c: usize| if r == c { 1.0 } else { 2.0 };
            let (mut h, mut q) = (vec![], vec![0.0; 6]);
            for r in 0..3 {
                for c in r..3 {
                    h.push((index[r][c], index[r][c], 2.0 * weight(r, c)));
                    q[index[r][c]] = -2.0 * weight(r, c) * target[(r, c)];
                }
            }
            let x = programme.solve(&h, &q).expect("solvable");
            let m = Matrix3::from_fn(|r, c| x[index[r][c]]);
            assert!(m.symmetric_eigenvalues().min() > -1e-7);
            let error = (m - target).norm();
            assert!(error < last + 1e-7);
            last = error;
            basis = super::super::fit::adapted_basis(&m);
        }
        assert!(last < 1.02 * (best - target).norm(), "{last}");
    }
}
