/// The published data set's `tube_configurations` format (one text file of nodes and edges a scene).
///
/// ```
/// <number of tubes>
/// per tube:  <tube id> <node count> <edge count>
/// per node:  <node id> <x> <y> <z> <radius>
/// per edge:  <edge id> <node id> <node id> <order> <radius> <cx> <cy> <cz> <qw> <qx> <qy> <qz> <length>
/// ```
/// Metres, world frame; c is the cylinder's middle, q turns +z into its axis; orders count from 1 in the
/// files, from 0 in Cylinder. Nodes stand in any order. The format knows neither mass nor wall thickness.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {

/// The file's tubes, posed by the identity (their nodes are in the world frame already), with mass and wall
/// thickness 0. Throws IoError naming file and line where the text is not such a scene: counts and lines
/// disagree, an edge's centre, length or axis is not that of its nodes, or a tube's parts have different
/// radii.
std::vector<PlacedTube> read_tubes_txt(const std::string& path);

/// As read_tubes_txt, from a text; `name` stands for the file in messages.
std::vector<PlacedTube> parse_tubes_txt(std::string_view text, const std::string& name);

/// The tubes as such a text; tube k has the id k, its node i the id i + 1. World coordinates read back
/// exactly.
std::string format_tubes_txt(const std::vector<PlacedTube>& tubes);

}  // namespace tubebin::scene
