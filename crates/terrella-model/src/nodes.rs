//! The node hierarchy, flattened: each mesh with its transform to the axes of the model (specification, section 3.5).

use super::MAX_DEPTH;
use super::container::Container;
use super::error::{ModelError, ModelFault};
use super::json::Node;
use glam::{DMat4, DQuat, DVec3};

/// A mesh where a node places it.
pub struct PlacedMesh {
    /// Its place in the document.
    pub mesh: u64,
    /// JSON pointer of the reference.
    pub pointer: String,
    pub model_from_mesh: DMat4,
}

/// All meshes of the file's default scene, or of its first one; without scenes, of all nodes.
pub fn placed_meshes(container: &Container) -> Result<Vec<PlacedMesh>, ModelError> {
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
    let mut placed = Vec::new();
    let mut is_reached = vec![false; document.nodes.len()];
    let from = "/scenes".to_owned();
    let mut waiting: Vec<_> = roots
        .into_iter()
        .rev()
        .map(|root| (root, DMat4::IDENTITY, 0, from.clone()))
        .collect();
    while let Some((index, model_from_parent, depth, from)) = waiting.pop() {
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
        let model_from_node = model_from_parent * parent_from_node(node);
        if !model_from_node.is_finite() {
            let (what, at) = ("the transform of node", index as usize);
            return Err(container.error(ModelFault::NotFinite { what, at }, pointer));
        }
        if let Some(mesh) = node.mesh {
            placed.push(PlacedMesh {
                mesh,
                pointer: format!("{pointer}/mesh"),
                model_from_mesh: model_from_node,
            });
        }
        let children = node.children.iter().rev();
        waiting.extend(children.map(|child| (*child, model_from_node, depth + 1, pointer.clone())));
    }
    Ok(placed)
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
