//! The node hierarchy, flattened: each mesh with its transform to the axes of the model (specification, section 3.5).

use super::container::Container;
use super::error::{ModelError, ModelFault};
use super::json::Node;
use super::{Joint, MAX_DEPTH};
use glam::{DMat4, DQuat, DVec3};
use terrella_files::printable;

/// Most names of nodes in a message.
const MAX_NAMED: usize = 20;

/// A mesh where a node places it.
pub struct PlacedMesh {
    /// Its place in the document.
    pub mesh: u64,
    /// JSON pointer of the reference.
    pub pointer: String,
    pub model_from_mesh: DMat4,
    /// The joint that it turns with.
    pub joint: Option<usize>,
}

/// The meshes of a file, and the nodes among theirs that are turned.
pub struct Placed {
    pub meshes: Vec<PlacedMesh>,
    /// In the order of the names that were asked for.
    pub joints: Vec<Joint>,
}

/// A node on the way to be placed.
struct Waiting {
    index: u64,
    model_from_parent: DMat4,
    depth: usize,
    /// JSON pointer of what refers to it.
    from: String,
    joint: Option<usize>,
}

/// All meshes of the scene that the file shows by default, or of its first one; without scenes, of all nodes. `turned` are the names of nodes
/// that are turned.
pub fn placed_meshes(container: &Container, turned: &[&str]) -> Result<Placed, ModelError> {
    let document = &container.document;
    let scene = document
        .scene
        .or((!document.scenes.is_empty()).then_some(0));
    let roots = match scene {
        Some(index) => {
            let scene = container.object(&document.scenes, "scene", index, "/scene")?;
            scene.nodes.clone()
        }
        None => roots(&document.nodes),
    };
    let mut meshes = Vec::new();
    let mut joints: Vec<Option<Joint>> = vec![None; turned.len()];
    let mut is_reached = vec![false; document.nodes.len()];
    let from = "/scenes".to_owned();
    let mut waiting: Vec<_> = roots
        .into_iter()
        .rev()
        .map(|index| Waiting {
            index,
            model_from_parent: DMat4::IDENTITY,
            depth: 0,
            from: from.clone(),
            joint: None,
        })
        .collect();
    while let Some(next) = waiting.pop() {
        let Waiting {
            index, depth, from, ..
        } = next;
        let node = container.object(&document.nodes, "node", index, &from)?;
        let pointer = format!("/nodes/{index}");
        let reached = usize::try_from(index)
            .ok()
            .and_then(|at| is_reached.get_mut(at));
        if reached.is_none_or(|reached| std::mem::replace(reached, true)) {
            return Err(container.error(ModelFault::Cycle(index), from));
        }
        if depth > MAX_DEPTH {
            let fault = ModelFault::TooMany {
                what: "nodes in a row below one another",
                count: depth as u64,
                limit: MAX_DEPTH as u64,
            };
            return Err(container.error(fault, pointer));
        }
        let model_from_node = next.model_from_parent * parent_from_node(node);
        if !model_from_node.is_finite() {
            let (what, at) = ("the transform of node", index as usize);
            return Err(container.error(ModelFault::NotFinite { what, at }, pointer));
        }
        let named = node.name.as_deref();
        let own = turned.iter().position(|name| Some(*name) == named);
        if let Some(slot) = own.and_then(|own| joints.get_mut(own)) {
            let joint = Joint {
                name: named.unwrap_or_default().to_owned(),
                parent: next.joint,
                model_from_node,
            };
            if let Some(first) = slot.replace(joint) {
                return Err(container.error(ModelFault::TwoNodes(first.name), pointer));
            }
        }
        let joint = own.or(next.joint);
        if let Some(mesh) = node.mesh {
            meshes.push(PlacedMesh {
                mesh,
                pointer: format!("{pointer}/mesh"),
                model_from_mesh: model_from_node,
                joint,
            });
        }
        let children = node.children.iter().rev();
        waiting.extend(children.map(|child| Waiting {
            index: *child,
            model_from_parent: model_from_node,
            depth: depth + 1,
            from: pointer.clone(),
            joint,
        }));
    }
    let found = turned.iter().zip(joints);
    let found = found.map(|(wanted, joint)| {
        let missing = || ModelFault::NoNode {
            wanted: printable(wanted),
            nodes: names(&document.nodes, &is_reached),
        };
        joint.ok_or_else(|| container.error(missing(), ""))
    });
    Ok(Placed {
        joints: found.collect::<Result<_, _>>()?,
        meshes,
    })
}

/// The names of the nodes that are shown, for a message.
fn names(nodes: &[Node], is_shown: &[bool]) -> String {
    let shown = nodes
        .iter()
        .zip(is_shown)
        .filter(|(_, is_shown)| **is_shown);
    let named = || shown.clone().filter_map(|(node, _)| node.name.as_deref());
    let few: Vec<_> = named()
        .take(MAX_NAMED)
        .map(|name| format!("{:?}", printable(name)))
        .collect();
    match (few.is_empty(), named().nth(MAX_NAMED).is_some()) {
        (true, _) => "without names".to_owned(),
        (false, true) => few.join(", ") + ", …",
        (false, false) => few.join(", "),
    }
}

/// Nodes without a parent.
fn roots(nodes: &[Node]) -> Vec<u64> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| &node.children) {
        let place = usize::try_from(*child).ok();
        if let Some(slot) = place.and_then(|place| is_child.get_mut(place)) {
            *slot = true;
        }
    }
    let roots = (0..).zip(&is_child).filter(|(_, is_child)| !**is_child);
    roots.map(|(index, _)| index).collect()
}

fn parent_from_node(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, DQuat::from_array);
    // Rounded in files; a rotation of no length turns nothing.
    let rotation = match rotation.length_squared() > 0.0 && rotation.is_finite() {
        true => rotation.normalize(),
        false => DQuat::IDENTITY,
    };
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, DVec3::from_array),
        rotation,
        node.translation.map_or(DVec3::ZERO, DVec3::from_array),
    )
}
