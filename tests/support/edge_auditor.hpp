// SPDX-License-Identifier: BSD-3-Clause
// A dense look at an edge that knows nothing of certificates, motion bounds, checkers or their tables.
//
// Every pair of bodies that counts is followed along the edge by exact distances of the two shapes. Samples are so close
// that between two of them no point of one body moves further, seen from the other, than half of the room that the pair has,
// or than `resolution` where that is more: contact between two samples would have to use up twice the measured motion.
//
// Motion is measured, not bounded: forward kinematics at states between which nothing turns by more than 0.2 rad; how far
// the centre of a sphere around the body went, and how far it turned about it. Bodies that are rigid to each other are a
// cluster and move as one. With margins a distance counts less by that of its pair. Where the boxes of the shapes are far
// enough apart for an interval no distance is taken.
#pragma once

#include "leeway/leeway.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

class EdgeAuditor
{
public:
	struct Look
	{
		bool contact = false;
		double t = 0;            ///< of the contact, otherwise of the least distance measured
		double least = INFINITY; ///< of all distances measured
		bool self = false;       ///< its bodies: two links, or link and object
		std::uint32_t link = LW_INVALID_INDEX, other = LW_INVALID_INDEX;
		std::uint64_t distances = 0, poses = 0;
	};

	/// The margin taken off the distance of two links, or of a link and an object.
	using Margin = std::function<double( bool self, std::uint32_t link, std::uint32_t other )>;

	/// @param variables of the group; everything else stands. @param resolution metres
	/// @param margin none if empty; all distances below are then distances less margins
	EdgeAuditor( const lw_robot* robot, const lw_scene* scene, const std::vector<std::uint32_t>& variables,
	    const double* reference, const std::vector<lw_link_object_pair>& allowed = {}, double resolution = 1e-4,
	    Margin margin = {} )
	    : m_robot( robot ), m_scene( scene ), m_resolution( resolution ), m_margin( std::move( margin ) )
	{
		const lw_query_def def = lw_query_def_default();
		lw_query* query = nullptr;
		require( lw_query_create( &def, nullptr, nullptr, nullptr, &query ) );
		m_query.reset( query );
		m_scratch.resize( lw_robot_variable_count( robot ) );
		m_reference.resize( lw_robot_link_count( robot ) );
		require( lw_robot_fk( robot, reference, m_reference.data() ) );
		findClusters( variables );
		listPairs( allowed );
		for ( const Pair& pair : m_still )
		{
			if ( m_still_least > 0 && gap( pair, m_reference ) < m_still_least )
			{
				m_still_least = std::min( m_still_least, distance( pair, m_reference, { 0, m_still_least, 0 } ).upper );
			}
		}
	}

	/// Looks for a state with a clearance of min_d or less among those with t in [0, end]. States are full robot states.
	Look look( const double* from, const double* to, double min_d = 0, double end = 1 )
	{
		m_from.assign( from, from + m_scratch.size() );
		m_to.assign( to, to + m_scratch.size() );
		m_min_d = min_d;
		m_end = end;
		m_look = Look();
		m_look.least = m_still_least;
		m_look.contact = m_still_least <= min_d;
		layGrid();
		for ( std::size_t i = 0; i < m_items.size() && !m_look.contact; ++i )
		{
			std::vector<Open> open;
			for ( const std::uint32_t pair : m_items[i].pairs )
			{
				open.push_back( { pair, whole, -1 } );
			}
			cover( m_items[i], 0, whole, open );
		}
		return m_look;
	}

	/// The exact least distance at a full state: of everything, or of one pair (links if self, otherwise link and object).
	double clearance( const double* full )
	{
		return clearanceOf( full, []( const Pair& ) { return true; } );
	}
	double clearance( const double* full, bool self, std::uint32_t link, std::uint32_t other )
	{
		return clearanceOf( full,
		    [this, self, link, other]( const Pair& pair )
		    {
			    const std::uint32_t a = m_bodies[pair.body].link;
			    return pair.self == self && ( ( a == link && otherName( pair ) == other ) ||
			                                    ( self && a == other && otherName( pair ) == link ) );
		    } );
	}

	std::size_t pairCount() const
	{
		std::size_t count = 0;
		for ( const Item& item : m_items )
		{
			count += item.pairs.size();
		}
		return count;
	}

private:
	using Poses = std::vector<lw_transform>;
	using Position = std::uint64_t; ///< of t: t = end * position / whole
	static constexpr Position whole = Position{ 1 } << 40;

	struct Body
	{
		const lw_shape* shape;
		std::uint32_t link; ///< LW_INVALID_INDEX: an obstacle, `pose` in the world
		lw_transform pose;  ///< in the link
		lw_shape_info info;
		lw_vec3 center; ///< of the bounding sphere, in the link
		std::uint32_t object = LW_INVALID_INDEX;
	};
	struct Pair
	{
		std::uint32_t body, other; ///< other: a body if self, otherwise an obstacle
		bool self;
		double margin = 0;
	};
	/// Links that are rigid to each other, with a sphere around their bodies, in the frame of the first one.
	struct Cluster
	{
		std::set<std::uint32_t> above; ///< joints of the group above it
		std::uint32_t link;
		std::vector<std::uint32_t> bodies;
		lw_vec3 center;
		double radius;
	};
	/// A cluster seen from a link, or from the world, and its path up to each point of the grid.
	struct Mover
	{
		std::uint32_t cluster, frame;
		std::vector<double> path;
		bool measured = false;
	};
	/// All pairs of a cluster with another one, or with an obstacle.
	struct Item
	{
		std::uint32_t mover, other_mover; ///< LW_INVALID_INDEX: does not move
		bool self;
		std::uint32_t cluster, other; ///< cluster or obstacle
		std::vector<std::uint32_t> pairs;
		double margin = 0; ///< the largest of them
	};
	/// A pair that is not settled on an interval, with its last sample (distance < 0: none yet).
	struct Open
	{
		std::uint32_t pair;
		Position at;
		double distance;
	};

	static void require( lw_status status )
	{
		if ( status != LW_OK )
		{
			throw std::runtime_error( std::string( "the audit: " ) + lw_status_name( status ) );
		}
	}

	static double norm( double x, double y, double z ) { return std::sqrt( x * x + y * y + z * z ); }

	// ---- bodies and pairs -------------------------------------------------------------------------------------------

	Body makeBody( const lw_shape* shape, std::uint32_t link, const lw_transform& pose ) const
	{
		Body body = { shape, link, pose, lw_shape_get_info( shape ), {}, LW_INVALID_INDEX };
		const lw_vec3 center = { body.info.sphere_center[0], body.info.sphere_center[1], body.info.sphere_center[2] };
		body.center = lw_transform_point( &pose, center );
		return body;
	}

	std::set<std::uint32_t> jointsAbove( std::uint32_t link, const std::vector<bool>& in_group ) const
	{
		std::set<std::uint32_t> above;
		for ( std::uint32_t joint = lw_robot_link_joint( m_robot, link ); joint != LW_INVALID_INDEX;
		      joint = lw_robot_link_joint( m_robot, lw_robot_joint_parent( m_robot, joint ) ) )
		{
			const std::uint32_t leader = lw_robot_joint_mimic( m_robot, joint );
			const std::uint32_t variable = lw_robot_joint_variable( m_robot, leader != LW_INVALID_INDEX ? leader : joint );
			if ( variable != LW_INVALID_INDEX && in_group[variable] )
			{
				above.insert( joint );
			}
		}
		return above;
	}

	void findClusters( const std::vector<std::uint32_t>& variables )
	{
		std::vector<bool> in_group( m_scratch.size(), false );
		for ( const std::uint32_t variable : variables )
		{
			in_group[variable] = true;
		}
		for ( std::uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
		{
			const lw_body_def def = lw_robot_body( m_robot, i );
			m_bodies.push_back( makeBody( def.shape, def.link, def.link_from_shape ) );
			const std::set<std::uint32_t> above = jointsAbove( def.link, in_group );
			std::uint32_t c = 0;
			while ( c < m_clusters.size() && m_clusters[c].above != above )
			{
				++c;
			}
			if ( c == m_clusters.size() )
			{
				m_clusters.push_back( { above, def.link, {}, {}, 0 } );
			}
			m_clusters[c].bodies.push_back( i );
			m_cluster_of.push_back( c );
		}
		for ( Cluster& cluster : m_clusters )
		{
			bound( cluster );
		}
	}

	void bound( Cluster& cluster ) const
	{
		const lw_transform here = lw_transform_inverse( &m_reference[cluster.link] );
		std::vector<lw_vec3> centers;
		lw_vec3 mean = { 0, 0, 0 };
		for ( const std::uint32_t b : cluster.bodies )
		{
			const lw_transform from = lw_transform_multiply( &here, &m_reference[m_bodies[b].link] );
			const lw_vec3 c = lw_transform_point( &from, m_bodies[b].center );
			centers.push_back( c );
			const double share = 1.0 / static_cast<double>( cluster.bodies.size() );
			mean = { mean.x + c.x * share, mean.y + c.y * share, mean.z + c.z * share };
		}
		cluster.center = mean;
		for ( std::size_t i = 0; i < centers.size(); ++i )
		{
			const lw_vec3 c = centers[i];
			cluster.radius = std::max( cluster.radius,
			    norm( c.x - mean.x, c.y - mean.y, c.z - mean.z ) + m_bodies[cluster.bodies[i]].info.sphere_radius );
		}
	}

	std::uint32_t moverOf( std::uint32_t cluster, std::uint32_t frame )
	{
		for ( std::uint32_t i = 0; i < m_movers.size(); ++i )
		{
			if ( m_movers[i].cluster == cluster && m_movers[i].frame == frame )
			{
				return i;
			}
		}
		m_movers.push_back( { cluster, frame, {}, false } );
		return static_cast<std::uint32_t>( m_movers.size() - 1 );
	}

	/// The nearest link that both links hang from.
	std::uint32_t commonLink( std::uint32_t a, std::uint32_t b ) const
	{
		std::set<std::uint32_t> of_a;
		for ( std::uint32_t link = a;; link = lw_robot_joint_parent( m_robot, lw_robot_link_joint( m_robot, link ) ) )
		{
			of_a.insert( link );
			if ( lw_robot_link_joint( m_robot, link ) == LW_INVALID_INDEX )
			{
				break;
			}
		}
		while ( of_a.count( b ) == 0 )
		{
			b = lw_robot_joint_parent( m_robot, lw_robot_link_joint( m_robot, b ) );
		}
		return b;
	}

	void addPair( Pair pair, std::uint32_t other )
	{
		setMargin( pair );
		const std::uint32_t cluster = m_cluster_of[pair.body];
		const auto key = std::make_tuple( pair.self, cluster, other );
		const auto [place, is_new] = m_item_of.emplace( key, m_items.size() );
		if ( is_new )
		{
			Item item = { LW_INVALID_INDEX, LW_INVALID_INDEX, pair.self, cluster, other, {}, 0 };
			const std::uint32_t frame =
			    pair.self ? commonLink( m_clusters[cluster].link, m_clusters[other].link ) : LW_INVALID_INDEX;
			item.mover = moverOf( cluster, frame );
			item.other_mover = pair.self ? moverOf( other, frame ) : LW_INVALID_INDEX;
			m_items.push_back( item );
		}
		Item& item = m_items[place->second];
		item.margin = std::max( item.margin, pair.margin );
		item.pairs.push_back( static_cast<std::uint32_t>( m_pairs.size() ) );
		m_pairs.push_back( pair );
	}

	/// Pairs whose relative pose the group changes, less the allowed ones; and bodies that never move against the scene.
	void listPairs( const std::vector<lw_link_object_pair>& allowed )
	{
		for ( std::uint32_t i = 0; m_scene != nullptr && i < lw_scene_shape_count( m_scene ); ++i )
		{
			const lw_scene_shape_def def = lw_scene_shape( m_scene, i );
			m_obstacles.push_back( makeBody( def.shape, LW_INVALID_INDEX, def.world_from_shape ) );
			m_obstacles.back().object = def.object;
		}
		for ( std::uint32_t a = 0; a < m_bodies.size(); ++a )
		{
			const Cluster& cluster = m_clusters[m_cluster_of[a]];
			for ( std::uint32_t k = 0; k < m_obstacles.size(); ++k )
			{
				const bool counts = std::none_of( allowed.begin(), allowed.end(),
				    [&]( const lw_link_object_pair& p )
				    { return p.link == m_bodies[a].link && p.object == m_obstacles[k].object; } );
				if ( counts && cluster.above.empty() )
				{
					m_still.push_back( { a, k, false } );
					setMargin( m_still.back() );
				}
				else if ( counts )
				{
					addPair( { a, k, false }, k );
				}
			}
			for ( std::uint32_t b = a + 1; b < m_bodies.size(); ++b )
			{
				if ( cluster.above != m_clusters[m_cluster_of[b]].above &&
				     !lw_robot_pair_allowed( m_robot, m_bodies[a].link, m_bodies[b].link ) )
				{
					addPair( { a, b, true }, m_cluster_of[b] );
				}
			}
		}
	}

	void setMargin( Pair& pair ) const
	{
		pair.margin = m_margin ? m_margin( pair.self, m_bodies[pair.body].link, otherName( pair ) ) : 0;
	}

	std::uint32_t otherName( const Pair& pair ) const
	{
		return pair.self ? m_bodies[pair.other].link : m_obstacles[pair.other].object;
	}

	// ---- poses and motion -------------------------------------------------------------------------------------------

	void poseAt( Position position, Poses& out )
	{
		const double t = m_end * ( static_cast<double>( position ) / static_cast<double>( whole ) );
		lw_robot_interpolate( m_robot, m_from.data(), m_to.data(), t, m_scratch.data() );
		out.resize( m_reference.size() );
		require( lw_robot_fk( m_robot, m_scratch.data(), out.data() ) );
		++m_look.poses;
	}

	/// Poses at a position. Stays valid until trim().
	const Poses& poses( Position position )
	{
		const auto [place, is_new] = m_known.emplace( position, m_used );
		if ( is_new )
		{
			if ( m_used == m_pool.size() )
			{
				m_pool.push_back( std::make_unique<Poses>() );
			}
			poseAt( position, *m_pool[m_used++] );
		}
		return *m_pool[place->second];
	}

	void trim()
	{
		if ( m_used > 2048 )
		{
			m_used = 0;
			m_known.clear();
		}
	}

	lw_transform seenFrom( std::uint32_t frame, std::uint32_t link, const Poses& at ) const
	{
		if ( frame == LW_INVALID_INDEX )
		{
			return at[link];
		}
		const lw_transform inverse = lw_transform_inverse( &at[frame] );
		return lw_transform_multiply( &inverse, &at[link] );
	}

	/// How far a cluster's points go at most between two poses (second), and by how many radians it turns (first).
	std::pair<double, double> motion( const Cluster& cluster, const lw_transform& f, const lw_transform& t ) const
	{
		const lw_vec3 a = lw_transform_point( &f, cluster.center ), b = lw_transform_point( &t, cluster.center );
		double turned = 0; // Frobenius norm of the difference of the rotations: sqrt( 2 ) times the chord of the turn
		for ( int row = 0; row < 3; ++row )
		{
			for ( int column = 0; column < 3; ++column )
			{
				const double d = t.r[row][column] - f.r[row][column];
				turned += d * d;
			}
		}
		const double chord = std::sqrt( turned / 2 );
		return { chord, 1.002 * ( norm( a.x - b.x, a.y - b.y, a.z - b.z ) + chord * cluster.radius ) };
	}

	/// So many steps that no cluster turns by more than 0.2 rad in one: a chord is then its arc to 0.2 %.
	void layGrid()
	{
		double turns = 0;
		for ( std::uint32_t i = 0; i < m_scratch.size(); ++i )
		{
			const lw_variable_info info = lw_robot_variable( m_robot, i );
			const double d = std::abs( m_to[i] - m_from[i] );
			const lw_joint_type type = lw_robot_joint_type( m_robot, info.joint );
			const bool is_shift = type == LW_JOINT_PRISMATIC || ( type == LW_JOINT_PLANAR && info.component < 2 ) ||
			                      ( type == LW_JOINT_FLOATING && info.component < 3 );
			turns += is_shift ? 0 : info.wraps ? std::min( d, 2 * M_PI ) : d;
		}
		m_cells = 4;
		while ( 0.4 * static_cast<double>( m_cells ) < turns * m_end && m_cells < 4096 )
		{
			m_cells *= 2;
		}
		m_known.clear();
		m_used = 0;
		for ( Mover& mover : m_movers )
		{
			mover.measured = false;
		}
	}

	const std::vector<double>& pathOf( Mover& mover )
	{
		if ( !mover.measured )
		{
			mover.measured = true;
			mover.path.assign( m_cells + 1, 0.0 );
			const Cluster& cluster = m_clusters[mover.cluster];
			lw_transform before = seenFrom( mover.frame, cluster.link, poses( 0 ) );
			for ( std::size_t i = 1; i <= m_cells; ++i )
			{
				const lw_transform now = seenFrom( mover.frame, cluster.link, poses( i * ( whole / m_cells ) ) );
				const auto [turn, way] = motion( cluster, before, now );
				if ( turn > 0.2 && m_cells < 65536 ) // a joint that follows another with a large factor
				{
					m_cells *= 2;
					for ( Mover& other : m_movers )
					{
						other.measured = false;
					}
					return pathOf( mover );
				}
				mover.path[i] = mover.path[i - 1] + way;
				before = now;
			}
		}
		return mover.path;
	}

	double path( std::uint32_t index, Position from, Position to )
	{
		if ( index == LW_INVALID_INDEX || from == to )
		{
			return 0;
		}
		Mover& mover = m_movers[index];
		const std::vector<double>& prefix = pathOf( mover );
		const Position low = std::min( from, to ), high = std::max( from, to ), cell = whole / m_cells;
		const std::size_t first = low / cell, last = ( high + cell - 1 ) / cell;
		if ( last - first > 1 || high - low == cell )
		{
			return prefix[last] - prefix[first];
		}
		const Cluster& cluster = m_clusters[mover.cluster];
		const lw_transform a = seenFrom( mover.frame, cluster.link, poses( low ) );
		return motion( cluster, a, seenFrom( mover.frame, cluster.link, poses( high ) ) ).second;
	}

	double path( const Item& item, Position from, Position to )
	{
		return path( item.mover, from, to ) + path( item.other_mover, from, to );
	}

	// ---- room -------------------------------------------------------------------------------------------------------

	lw_transform worldPose( const Body& body, const Poses& at ) const
	{
		return body.link == LW_INVALID_INDEX ? body.pose : lw_transform_multiply( &at[body.link], &body.pose );
	}

	static double toBox( const lw_vec3& p, const lw_transform& pose, const lw_shape_info& info )
	{
		const double d[3] = { p.x - pose.t[0], p.y - pose.t[1], p.z - pose.t[2] };
		double squared = 0;
		for ( int i = 0; i < 3; ++i )
		{
			const double local = pose.r[0][i] * d[0] + pose.r[1][i] * d[1] + pose.r[2][i] * d[2];
			const double out = std::max( 0.0, std::max( info.box_min[i] - local, local - info.box_max[i] ) );
			squared += out * out;
		}
		return std::sqrt( squared );
	}

	/// A lower bound of the distance of two clusters, or a cluster and an obstacle.
	double gap( const Item& item, const Poses& at ) const
	{
		const Cluster& a = m_clusters[item.cluster];
		const lw_vec3 ca = lw_transform_point( &at[a.link], a.center );
		if ( !item.self )
		{
			return toBox( ca, m_obstacles[item.other].pose, m_obstacles[item.other].info ) - a.radius - item.margin;
		}
		const Cluster& b = m_clusters[item.other];
		const lw_vec3 cb = lw_transform_point( &at[b.link], b.center );
		return norm( ca.x - cb.x, ca.y - cb.y, ca.z - cb.z ) - a.radius - b.radius - item.margin;
	}

	double gap( const Pair& pair, const Poses& at ) const
	{
		const Body &a = m_bodies[pair.body], &b = pair.self ? m_bodies[pair.other] : m_obstacles[pair.other];
		const lw_vec3 ca = lw_transform_point( &at[a.link], a.center );
		const double gap_a = toBox( ca, worldPose( b, at ), b.info ) - a.info.sphere_radius;
		const lw_vec3 cb = b.link == LW_INVALID_INDEX ? b.center : lw_transform_point( &at[b.link], b.center );
		return std::max( gap_a, toBox( cb, worldPose( a, at ), a.info ) - b.info.sphere_radius ) - pair.margin;
	}

	lw_clearance distance( const Pair& pair, const Poses& at, const lw_range& range )
	{
		const Body &a = m_bodies[pair.body], &b = pair.self ? m_bodies[pair.other] : m_obstacles[pair.other];
		const lw_transform pa = worldPose( a, at ), pb = worldPose( b, at );
		const lw_range farther = { range.min_d + pair.margin, range.max_d + pair.margin, range.alpha };
		lw_clearance out;
		require( lw_shape_distance( a.shape, &pa, b.shape, &pb, &farther, m_query.get(), &out ) );
		out.lower -= pair.margin;
		out.upper -= pair.margin;
		++m_look.distances;
		return out;
	}

	template <typename Filter> double clearanceOf( const double* full, const Filter& counts )
	{
		Poses at( m_reference.size() );
		require( lw_robot_fk( m_robot, full, at.data() ) );
		double least = INFINITY;
		for ( const std::vector<Pair>* pairs : { &m_pairs, &m_still } )
		{
			for ( const Pair& pair : *pairs )
			{
				if ( least > 0 && counts( pair ) && gap( pair, at ) < least )
				{
					least = std::min( least, distance( pair, at, { 0, least, 0 } ).upper );
				}
			}
		}
		return least;
	}

	/// Measures the pair at a position, no further than `far`. @return its distance, or infinity if that is more
	double measure( const Pair& pair, Position position, double far )
	{
		const lw_range range = { m_min_d, far, 0 };
		const lw_clearance c = distance( pair, poses( position ), range );
		if ( c.upper < m_look.least )
		{
			m_look.least = c.upper;
			m_look.t = m_end * ( static_cast<double>( position ) / static_cast<double>( whole ) );
			m_look.self = pair.self;
			m_look.link = m_bodies[pair.body].link;
			m_look.other = otherName( pair );
		}
		if ( c.kind == LW_CLEARANCE_VIOLATION )
		{
			m_look.contact = true;
		}
		return c.upper;
	}

	/// Settles the open pairs of an item on [low, high], or finds a contact there.
	void cover( const Item& item, Position low, Position high, const std::vector<Open>& open )
	{
		trim();
		const Position middle = low + ( high - low ) / 2;
		const double half = std::max( path( item, low, middle ), path( item, middle, high ) );
		if ( item.pairs.size() > 1 && gap( item, poses( middle ) ) - m_min_d >= 2 * half )
		{
			return;
		}
		std::vector<Open> left;
		for ( const Open& o : open )
		{
			const Pair& pair = m_pairs[o.pair];
			const double room = o.distance - m_min_d;
			if ( o.distance >= 0 && room >= 2 * std::max( path( item, o.at, low ), path( item, o.at, high ) ) )
			{
				continue;
			}
			const double least = gap( pair, poses( middle ) ) - m_min_d;
			if ( least >= 2 * half )
			{
				continue;
			}
			// An interval that a sample here cannot settle anyway is left to the halves: without a sample so far that is a
			// guess
			const double most = o.distance >= 0 ? room + path( item, o.at, middle ) : 2 * std::max( 0.0, least ) + 0.1;
			if ( most < 2 * half && 2 * half > m_resolution && high - low > 1 )
			{
				left.push_back( o );
				continue;
			}
			const double d = measure( pair, middle, m_min_d + std::max( 2 * half, m_resolution ) );
			if ( m_look.contact )
			{
				return;
			}
			if ( std::max( d - m_min_d, m_resolution ) < 2 * half && high - low > 1 )
			{
				left.push_back( { o.pair, middle, d } );
			}
		}
		if ( left.empty() )
		{
			return;
		}
		cover( item, low, middle, left );
		if ( !m_look.contact )
		{
			cover( item, middle, high, left );
		}
	}

	struct QueryDeleter
	{
		void operator()( lw_query* query ) const { lw_query_destroy( query ); }
	};

	const lw_robot* m_robot;
	const lw_scene* m_scene;
	const double m_resolution;
	const Margin m_margin;
	std::unique_ptr<lw_query, QueryDeleter> m_query;
	Poses m_reference;
	std::vector<Body> m_bodies, m_obstacles;
	std::vector<Cluster> m_clusters;
	std::vector<std::uint32_t> m_cluster_of;
	std::vector<Pair> m_pairs, m_still;
	std::vector<Item> m_items;
	std::map<std::tuple<bool, std::uint32_t, std::uint32_t>, std::size_t> m_item_of;
	std::vector<Mover> m_movers;
	double m_still_least = INFINITY;

	// of the edge that is looked at
	std::vector<double> m_from, m_to, m_scratch;
	double m_min_d = 0, m_end = 1;
	std::size_t m_cells = 1;
	std::unordered_map<Position, std::size_t> m_known;
	std::vector<std::unique_ptr<Poses>> m_pool;
	std::size_t m_used = 0;
	Look m_look;
};
