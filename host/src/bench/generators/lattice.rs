//! Shortest vectors of the dual lattice of a congruential generator, exactly.
//!
//! Successive `t` numbers of a generator with multiplier `a` and modulus `m` are points of a lattice. They lie on parallel
//! planes, and each family of planes is a vector `s` with `s . (1, a, ..., a^(t-1)) = 0 mod m`: the longer `s`, the closer
//! the planes. Those vectors form the dual lattice. Its basis is reduced by the method of Lenstra, Lenstra and Lovász, and
//! then all combinations that could be shorter than the shortest vector so far are gone through (Fincke and Pohst). All of
//! it is in exact fractions, so the result needs no trust in rounding.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

type Vector = Vec<BigInt>;

/// Squared length of the shortest vector but zero in 2 to `dimensions` dimensions.
pub(super) fn shortest_squares(multiplier: u64, modulus: u128, dimensions: usize) -> Vec<BigInt> {
    let (a, m) = (BigInt::from(multiplier), BigInt::from(modulus));
    let mut basis: Vec<Vector> = vec![vec![m.clone()]];
    let mut power = BigInt::one();
    let mut squares = Vec::new();
    for dimension in 2..=dimensions {
        power = power * &a % &m;
        for vector in &mut basis {
            vector.push(BigInt::zero());
        }
        let mut added = vec![BigInt::zero(); dimension];
        added[0] = -&power;
        added[dimension - 1] = BigInt::one();
        basis.push(added);
        reduce(&mut basis);
        squares.push(shortest_square(&basis));
    }
    squares
}

fn dot(a: &[BigInt], b: &[BigInt]) -> BigInt {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The orthogonal vectors behind a basis: their squared lengths, and each basis vector's share of those before it.
struct Orthogonal {
    squares: Vec<BigRational>,
    shares: Vec<Vec<BigRational>>,
}

impl Orthogonal {
    /// Gram and Schmidt's.
    fn of(basis: &[Vector]) -> Self {
        let (mut squares, mut shares) = (Vec::new(), Vec::<Vec<BigRational>>::new());
        for vector in basis {
            let mut own: Vec<BigRational> = Vec::new();
            let mut square = BigRational::from(dot(vector, vector));
            for (j, earlier) in basis[..shares.len()].iter().enumerate() {
                let mut product = BigRational::from(dot(vector, earlier));
                for l in 0..j {
                    product -= &own[l] * &shares[j][l] * &squares[l];
                }
                let share = product / &squares[j];
                square -= &share * &share * &squares[j];
                own.push(share);
            }
            squares.push(square);
            shares.push(own);
        }
        Self { squares, shares }
    }
}

/// Takes from `basis[k]` the whole multiples of those before it, nearest first.
fn reduce_size(basis: &mut [Vector], orthogonal: &mut Orthogonal, k: usize) {
    for j in (0..k).rev() {
        let multiple = orthogonal.shares[k][j].round().to_integer();
        if multiple.is_zero() {
            continue;
        }
        let (before, from_k) = basis.split_at_mut(k);
        for (component, other) in from_k[0].iter_mut().zip(&before[j]) {
            *component -= &multiple * other;
        }
        let multiple = BigRational::from(multiple);
        let (before, from_k) = orthogonal.shares.split_at_mut(k);
        for (share, other) in from_k[0].iter_mut().zip(&before[j]) {
            *share -= &multiple * other;
        }
        from_k[0][j] -= multiple;
    }
}

/// Lenstra, Lenstra and Lovász's reduction with their factor of 3/4.
fn reduce(basis: &mut [Vector]) {
    let factor = BigRational::new(3.into(), 4.into());
    let mut orthogonal = Orthogonal::of(basis);
    let mut k = 1;
    while k < basis.len() {
        reduce_size(basis, &mut orthogonal, k);
        let share = &orthogonal.shares[k][k - 1];
        if orthogonal.squares[k] >= (&factor - share * share) * &orthogonal.squares[k - 1] {
            k += 1;
        } else {
            basis.swap(k, k - 1);
            orthogonal = Orthogonal::of(basis);
            k = (k - 1).max(1);
        }
    }
}

fn shortest_square(basis: &[Vector]) -> BigInt {
    let shortest = basis.iter().map(|vector| dot(vector, vector)).min();
    let mut search = Search {
        orthogonal: Orthogonal::of(basis),
        coefficients: vec![BigInt::zero(); basis.len()],
        shortest: BigRational::from(shortest.expect("a basis has a vector")),
    };
    search.descend(basis.len(), &BigRational::zero());
    search.shortest.to_integer()
}

/// The search for a combination of the basis that is shorter than any so far.
struct Search {
    orthogonal: Orthogonal,
    coefficients: Vec<BigInt>,
    shortest: BigRational,
}

impl Search {
    /// Coefficients from `level` up are chosen and make `square` already; goes through all that fit below.
    fn descend(&mut self, level: usize, square: &BigRational) {
        let Some(k) = level.checked_sub(1) else {
            if !square.is_zero() {
                self.shortest = square.clone();
            }
            return;
        };
        let mut centre = BigRational::zero();
        for (j, coefficient) in self.coefficients.iter().enumerate().skip(level) {
            centre -= &self.orthogonal.shares[j][k] * coefficient;
        }
        let nearest = centre.round().to_integer();
        for step in [BigInt::one(), -BigInt::one()] {
            let mut coefficient = nearest.clone();
            if step.is_negative() {
                coefficient += &step;
            }
            loop {
                let off = &centre - &coefficient;
                let longer = square + &off * &off * &self.orthogonal.squares[k];
                if longer >= self.shortest {
                    break;
                }
                self.coefficients[k] = coefficient.clone();
                self.descend(k, &longer);
                coefficient += &step;
            }
        }
        self.coefficients[k] = BigInt::zero();
    }
}
