// SPDX-License-Identifier: BSD-3-Clause
// How far variables may be from the curve of a schedule: tolerances, spreads, lags. FORMAT.md, "One clock"
#pragma once

#include "certify/model.hpp"

namespace leeway::certify
{

/// Of one variable, as the file has it.
struct Deviation
{
	std::uint32_t track = 0;
	double tolerance = 0, lag = 0, spread = 0, since = 0;
};

/// @param model its joints tell the variables of a track that shift
std::vector<Deviation> deviationsOf( const Model& model, const Settings& settings );

/// Of piece k of a motion that begins at `begin`.
Tubes tubesOf( const std::vector<Piece>& pieces, std::size_t k, double begin, const std::vector<Deviation>& deviations );

/// Says of each pair whether variables of several tracks that move are between its bodies.
void setLate( const Model& model, const std::vector<Piece>& pieces, const std::vector<Deviation>& deviations,
    std::vector<Pair>& pairs );

/// A part of a Bezier curve. @param from, to in [0, 1]
std::vector<double> partOf( const std::vector<double>& points, std::size_t variables, double from, double to );

/// Puts the halves of a piece in its place.
void halvePiece( std::vector<Piece>& pieces, std::size_t k, std::size_t variables );

} // namespace leeway::certify
