//! Cores that overlap, section 4: who belongs together, and whether reference points are where the page says.

mod child;
mod overlap;
mod pair;

use nalgebra::DVector;

use super::error::OracleError;
use super::evaluation::bodies;
use super::geometry::{length, vector};
use super::obstacle::Body;
use super::scene::OracleScene;
pub use overlap::Sharing;
pub(super) use overlap::{common, in_sight, through};

/// Obstacles whose cores overlap, directly or through others.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleCluster {
    /// In the order of the scene.
    pub members: Vec<usize>,
    /// Which of them overlap, the smaller first.
    pub links: Vec<(usize, usize)>,
    /// Whether all of them have a point in common that is in sight of every polygon; never with a wall.
    pub common: Sharing,
    /// Those of them that are walls; they overlap each other nowhere, but the same obstacle may stick into several.
    pub walls: Vec<usize>,
}

impl OracleCluster {
    /// Whether there is one way only from each member to each other.
    pub fn is_tree(&self) -> bool {
        self.links.len() + 1 == self.members.len()
    }

    /// How many members one of them overlaps.
    pub fn neighbours(&self, member: usize) -> usize {
        self.links.iter().filter(|(a, b)| *a == member || *b == member).count()
    }

    /// Where a tree may begin: at all walls at once, or at one of those with most neighbours.
    pub fn roots(&self) -> Vec<Vec<usize>> {
        if !self.walls.is_empty() {
            return vec![self.walls.clone()];
        }
        let most = self.members.iter().map(|m| self.neighbours(*m)).max().unwrap_or(0);
        self.members.iter().copied().filter(|m| self.neighbours(*m) == most).map(|m| vec![m]).collect()
    }

    /// Everyone's parent in the tree from these roots; they and whoever cannot be reached have none.
    pub fn parents(&self, roots: &[usize]) -> Vec<(usize, Option<usize>)> {
        let mut found: Vec<(usize, Option<usize>)> = roots.iter().map(|root| (*root, None)).collect();
        let mut next = 0;
        while let Some((own, _)) = found.get(next).copied() {
            for (a, b) in &self.links {
                let other = if *a == own {
                    *b
                } else if *b == own {
                    *a
                } else {
                    continue;
                };
                if found.iter().all(|(seen, _)| *seen != other) {
                    found.push((other, Some(own)));
                }
            }
            next += 1;
        }
        found
    }

    /// Checks the reference points of the members, as the scene has them now; `own` are those that the scene had before.
    ///
    /// # Errors
    /// Says what is not as the page has it.
    pub fn check(&self, own: &OracleScene, scene: &OracleScene) -> Result<(), String> {
        let before = bodies(own).map_err(|e| e.to_string())?;
        let bodies = bodies(scene).map_err(|e| e.to_string())?;
        let inside = |point: &DVector<f64>, n: usize| bodies[n].sight(point) <= 1.0 + 1e-9;
        let shared = self.walls.is_empty() && {
            let first = bodies[self.members[0]].reference();
            let same = |n: &usize| length(&(bodies[*n].reference() - &first)) < 1e-9 * (1.0 + length(&first));
            self.members.iter().all(same)
        };
        if shared {
            let first = bodies[self.members[0]].reference();
            return match self.members.iter().find(|n| !inside(&first, **n)) {
                None => Ok(()),
                Some(n) => Err(format!("the point of all members is not in obstacle {n}: {:?}", first.as_slice())),
            };
        }
        if self.common == Sharing::Common && self.members.len() <= 8 {
            return Err(String::from("there is a point in common, and the members have no such reference point"));
        }
        let tree = self.is_tree();
        let mut complaints = Vec::new();
        for roots in self.roots() {
            if roots.iter().any(|root| scene.obstacles[*root].reference != own.obstacles[*root].reference) {
                complaints.push(format!("one of the roots {roots:?} has not kept its reference point"));
                continue;
            }
            let hub = self.walls.is_empty().then(|| bodies[roots[0]].reference());
            let wrong = self.parents(&roots).into_iter().find_map(|(child, parent)| {
                let parent = parent?;
                let leans = match (&hub, bodies[child].hub()) {
                    (Some(hub), Some(seen)) => length(&(hub - seen)) < 1e-9 * (1.0 + length(hub)),
                    // A child whose own is there already has nowhere to lean to.
                    (Some(hub), None) => length(&(hub - bodies[child].reference())) < 1e-9,
                    (None, seen) => seen.is_none(),
                };
                if !leans {
                    return Some(format!("{child} does not lean towards root {roots:?}"));
                }
                let with = |other: usize| {
                    child::check(&bodies[child], &before[child], &bodies[other], &before[other].reference())
                };
                // In a ring the page does not say which way round.
                let around = || self.members.iter().any(|other| self.linked(child, *other) && with(*other).is_ok());
                match with(parent) {
                    Err(_) if !tree && around() => None,
                    Err(complaint) => Some(format!("from root {roots:?}, {child} below {parent}: {complaint}")),
                    Ok(()) => None,
                }
            });
            match wrong {
                None => return Ok(()),
                Some(complaint) => complaints.push(complaint),
            }
        }
        let seen = |n: &usize| {
            let p = bodies[*n].reference();
            (*n, self.members.iter().map(|m| bodies[*m].gamma(&p)).collect::<Vec<_>>())
        };
        complaints.push(format!("{:?}", self.members.iter().map(seen).collect::<Vec<_>>()));
        Err(complaints.join("; "))
    }

    fn linked(&self, a: usize, b: usize) -> bool {
        self.links.contains(&(a.min(b), a.max(b)))
    }
}

/// How two cores of a scene stand to each other.
///
/// # Errors
/// Where the scene is not valid, or has no such obstacle.
pub fn sharing(scene: &OracleScene, a: usize, b: usize) -> Result<Sharing, OracleError> {
    let bodies = bodies(scene)?;
    match (bodies.get(a), bodies.get(b)) {
        (Some(a), Some(b)) => Ok(pairwise(a, b)),
        _ => Err(OracleError::Value("number of an obstacle")),
    }
}

/// How two cores stand to each other. Two walls always meet somewhere.
pub(super) fn pairwise(a: &Body, b: &Body) -> Sharing {
    match (a.wall, b.wall) {
        (false, false) => common(&[a, b]),
        (true, false) => through(a, b),
        (false, true) => through(b, a),
        (true, true) => Sharing::Common,
    }
}

/// All groups of two or more obstacles whose cores overlap; nothing where one overlap is too close to tell.
///
/// # Errors
/// Where the scene is not valid.
pub fn clusters(scene: &OracleScene) -> Result<Option<Vec<OracleCluster>>, OracleError> {
    let bodies = bodies(scene)?;
    let mut links = Vec::new();
    for a in 0..bodies.len() {
        for b in a + 1..bodies.len() {
            // Beyond their free spaces walls always meet; that is nowhere anybody is.
            if bodies[a].wall && bodies[b].wall {
                continue;
            }
            match pairwise(&bodies[a], &bodies[b]) {
                Sharing::Apart => {}
                Sharing::Unclear => return Ok(None),
                Sharing::Common => links.push((a, b)),
            }
        }
    }
    // The smallest number that can be reached names the group.
    let mut group: Vec<usize> = (0..bodies.len()).collect();
    for _ in 0..bodies.len() {
        for (a, b) in &links {
            let least = group[*a].min(group[*b]);
            (group[*a], group[*b]) = (least, least);
        }
    }
    let mut found = Vec::new();
    for name in 0..bodies.len() {
        let members: Vec<usize> = (0..bodies.len()).filter(|n| group[*n] == name).collect();
        if members.len() < 2 {
            continue;
        }
        let walls: Vec<usize> = members.iter().copied().filter(|n| bodies[*n].wall).collect();
        let all: Vec<&Body> = members.iter().map(|n| &bodies[*n]).collect();
        found.push(OracleCluster {
            common: if !walls.is_empty() { Sharing::Apart } else { in_sight(&all) },
            links: links.iter().copied().filter(|(a, _)| group[*a] == name).collect(),
            members,
            walls,
        });
    }
    Ok(Some(found))
}

/// The common reference point of two ellipsoids (p = 1) in the world; none for other shapes.
///
/// # Errors
/// Where the scene is not valid, or has no such obstacle.
pub fn pair_reference(scene: &OracleScene, a: usize, b: usize) -> Result<Option<Vec<f64>>, OracleError> {
    let bodies = bodies(scene)?;
    match (bodies.get(a), bodies.get(b)) {
        (Some(a), Some(b)) => Ok(pair::meeting(a, b).map(|x| x.as_slice().to_vec())),
        _ => Err(OracleError::Value("number of an obstacle")),
    }
}

/// The reference point of an obstacle in the world.
///
/// # Errors
/// Where the scene is not valid, or has no such obstacle.
pub fn reference_in_world(scene: &OracleScene, n: usize) -> Result<Vec<f64>, OracleError> {
    let bodies = bodies(scene)?;
    let body = bodies.get(n).ok_or(OracleError::Value("number of an obstacle"))?;
    Ok(body.reference().as_slice().to_vec())
}

/// Puts the reference point of an obstacle to a place in the world; one that is there already, to rounding, is left as it is.
///
/// # Errors
/// Where the scene is not valid, or has no such obstacle.
pub fn refer(scene: &mut OracleScene, n: usize, place: &[f64]) -> Result<(), OracleError> {
    let place = vector(place, scene.dimension, "reference")?;
    let bodies = bodies(scene)?;
    let body = bodies.get(n).ok_or(OracleError::Value("number of an obstacle"))?;
    if length(&(&place - body.reference())) > 1e-12 * (1.0 + length(&place)) {
        // As the page takes it in, where the core has shrunk.
        let local = body.local(&place).zip_map(&body.hard, |r, scale| r / scale.min(1.0));
        scene.obstacles[n].reference = local.as_slice().to_vec();
    }
    Ok(())
}

/// Puts the hub of an obstacle, its tree's root's reference point, to a place in the world.
///
/// # Errors
/// Where the scene is not valid, or has no such obstacle.
pub fn lean(scene: &mut OracleScene, n: usize, place: Option<&[f64]>) -> Result<(), OracleError> {
    let place = place.map(|place| vector(place, scene.dimension, "hub")).transpose()?;
    let bodies = bodies(scene)?;
    let body = bodies.get(n).ok_or(OracleError::Value("number of an obstacle"))?;
    scene.obstacles[n].hub = place.map(|place| body.local(&place).as_slice().to_vec());
    Ok(())
}

#[cfg(test)]
mod tests;
