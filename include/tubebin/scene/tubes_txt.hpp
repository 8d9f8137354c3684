/// The published data set's `tube_configurations` format (one text file of nodes and edges a scene).
///
/// ```
/// <number of tubes>
/// per tube:  <tube id> <node count> <edge count>
/// per node:  <node id> <x> <y> <z> <radius>
/// per edge:  <edge id> <node id> <node id> <order> <radius> <cx> <cy> <cz> <qw> <qx> <qy> <qz> <length>
/// ```
/// Metres, world frame; q turns +z into the cylinder's axis; orders count from 1 in the files.
#pragma once

#include <string>
#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin {

/// The file's tubes, posed by the identity (their nodes are in the world frame already).
/// Throws IoError naming file and line where the text is not such a scene.
std::vector<PlacedTube> read_tubes_txt(const std::string& path);

/// The tubes as such a text. Distances round-trip to 1e-9 m.
std::string format_tubes_txt(const std::vector<PlacedTube>& tubes);

}  // namespace tubebin
