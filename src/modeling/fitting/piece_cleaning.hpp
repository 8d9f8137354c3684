/// What one segment's fit cannot know: pieces that another one explains, and pieces that run into each other.
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Indices of the points that no piece explains: farther out than a tenth of a radius from every piece, its ends made
/// longer by what their places may be off. A point inside a piece is explained: no other surface can be there.
Segment unexplained_points(const std::vector<cloud::Point>& points, const std::vector<TubePiece>& pieces,
                           double spacing);

/// What is left of the cloud where its points that the pieces explain are taken away; without normals.
FilteredCloud without_pieces(const FilteredCloud& cloud, const std::vector<TubePiece>& pieces);

/// Drops thin pieces whose points longer, fully seen ones explain for the most part: in the groove between two tubes
/// that touch, normals of both mix to a tube that is not there.
void drop_explained_pieces(std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points, double spacing);

/// Cuts back ends that reach into another piece: centrelines nearer than half a radius are one tube's. Of two such
/// pieces the longer is cut. What has no length left is dropped.
void cut_overlaps(std::vector<TubePiece>& pieces);

}  // namespace tubebin::modeling
