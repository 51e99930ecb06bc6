// SPDX-License-Identifier: BSD-3-Clause
// Windows of time and the two tests that the checkers repeat: spheres far apart, and a direction that separates. Derivation: FORMAT.md
#pragma once

#include "certify/model.hpp"

#include <memory>
#include <vector>

namespace leeway::certify
{

/// A body of the robot or an obstacle, with its constant parts.
struct Body
{
	const Placed* placed;
	const Shape* shape;
	bool on_link; ///< placed on a link, else in the world
	Pose pose;    ///< in the link or the world
};

/// Part of a body at a middle state, and how it moves in the window.
struct Side
{
	const Body* body = nullptr;
	std::size_t range = 0;
	Pose pose;
	Vec middle{ 0, 0, 0 };
	std::array<Vec, 3> arms{}; ///< from the middle to three sides of the part's box
	double radius = 0;
	bool turns = false;                    ///< first order: x + s (turn x x + shift)
	Vec turn{ 0, 0, 0 }, shift{ 0, 0, 0 }; ///< zero of a body that no variable moves
	double rest = 0;                       ///< beyond it, of any point of the part
	double path = 0;                       ///< of the middle

	/// The greatest height of the part's box in a direction of any length, and the point there; world at the middle state.
	double boxHeight( const Vec& direction ) const;
	Vec boxPoint( const Vec& direction ) const;
};

/// The middle state of a window with all poses, and the range of each variable around it.
struct Window
{
	unsigned degree = 1;
	std::vector<double> points; ///< control points of this part of the curve
	unsigned depth = 0;
	double time = 0.5;                    ///< of the middle state, on the piece
	std::vector<double> speed, rest;      ///< [variables]: value = middle + s speed + r, |s| <= 1, |r| <= rest
	const Tubes* tubes = nullptr;         ///< of the piece
	std::vector<Pose> links;              ///< world from link
	std::vector<Vec> axes;                ///< of the joint above each link, world
	std::vector<Side> whole;              ///< bodies as obstacles see them, once they are needed
	std::unique_ptr<Window> first, later; ///< its halves, once they are needed
};

class Motion
{
public:
	/// @param model outlives this
	explicit Motion( const Model& model );
	/// Of the motion that is to be certified next: sizes that rounding depends on.
	void begin( const std::vector<Piece>& pieces );

	/// @param tubes outlives the window
	std::unique_ptr<Window> whole( const Piece& piece, const Tubes& tubes ) const;
	/// Makes the halves.
	void halve( Window& window ) const;
	const Body& body( std::uint32_t i ) const { return m_bodies[i]; }
	const Body& obstacle( std::uint32_t i ) const { return m_obstacles[i]; }
	/// @param late the pair's joints are those of several tracks
	Side side( const Body& body, std::size_t range, std::uint32_t ancestor, bool late, const Window& window ) const;
	/// The same of a whole body, seen from the root; it is kept.
	const Side& whole( std::uint32_t body, Window& window ) const;
	/// An obstacle, which rests.
	const Side& whole( std::uint32_t obstacle ) const { return m_resting[obstacle]; }
	/// Room that the spheres' test leaves beyond `need`; > 0 proves it.
	double spheres( const Side& a, const Side& b, double need ) const;
	/// Room that a direction from a to b leaves beyond `need`; > 0 proves it. @param direction of any length, world at the middle state
	/// @param boxes of the boxes around both, which is less
	double plane( const Side& a, const Side& b, const Vec& direction, double need, bool boxes ) const;
	const Model& model() const { return m_model; }
	/// Metres that cover all rounding of a test; the writer asks for twice as much.
	double rounding() const { return m_rounding; }

private:
	void finish( Window& window ) const;
	double sizeOf( const std::vector<Piece>& pieces ) const;

	const Model& m_model;
	double m_rounding = 0;
	std::vector<Body> m_bodies, m_obstacles;
	std::vector<Side> m_resting;        ///< of obstacles
	std::vector<Pose> m_origins;        ///< of links
	std::vector<std::uint32_t> m_moved; ///< the lowest link that a variable moves, from each link upwards; `nothing`
};

} // namespace leeway::certify
