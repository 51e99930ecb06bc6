// SPDX-License-Identifier: BSD-3-Clause
// Windows of time and the two tests that the checkers repeat: spheres far apart, and a direction that separates. Derivation: FORMAT.md
#pragma once

#include "certify/model.hpp"

#include <memory>
#include <vector>

namespace leeway::certify
{

/// The middle state of a window with all poses, and the range of each variable around it.
struct Window
{
	unsigned degree = 1;
	std::vector<double> points; ///< control points of this part of the curve
	unsigned depth = 0;
	double time = 0.5;                    ///< of the middle state, on the piece
	std::vector<double> speed, rest;      ///< [variables]: value = middle + s speed + r, |s| <= 1, |r| <= rest
	std::vector<Pose> links;              ///< world from link
	std::vector<Vec> axes;                ///< of the joint above each link, world
	std::unique_ptr<Window> first, later; ///< its halves, once they are needed
};

/// Part of a body or obstacle.
struct Part
{
	const Placed* placed;
	const Shape* shape;
	std::size_t range;
	bool on_link; ///< placed on a link, else in the world
};

class Motion
{
public:
	Motion( const Model& model, const std::vector<Piece>& pieces );

	std::unique_ptr<Window> whole( const Piece& piece ) const;
	/// Makes the halves.
	void halve( Window& window ) const;
	Pose poseOf( const Part& part, const Window& window ) const;
	Vec middleOf( const Part& part, const Window& window ) const;
	/// Room that the spheres' test leaves beyond `need`; > 0 proves it.
	double spheres( const Part& a, const Part& b, std::uint32_t ancestor, const Window& window, double need ) const;
	/// Room that a direction from a to b leaves beyond `need`; > 0 proves it. @param direction of any length, world at the middle state
	double plane( const Part& a, const Part& b, std::uint32_t ancestor, const Window& window, const Vec& direction,
	    double need ) const;
	const Model& model() const { return m_model; }
	/// Metres that cover all rounding of a test; the writer asks for twice as much.
	double rounding() const { return m_rounding; }

private:
	struct Bounds
	{
		Vec turn{ 0, 0, 0 }, shift{ 0, 0, 0 }; ///< first order: x + s (turn x x + shift)
		double rest = 0;                       ///< of any point of the sphere
		double path = 0;                       ///< of the sphere's centre
	};
	Bounds boundsOf( const Part& part, std::uint32_t ancestor, const Window& window ) const;
	void finish( Window& window ) const;
	double sizeOf( const std::vector<Piece>& pieces ) const;

	const Model& m_model;
	double m_rounding;
};

} // namespace leeway::certify
