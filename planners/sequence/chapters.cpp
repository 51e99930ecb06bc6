// SPDX-License-Identifier: BSD-3-Clause
// The scenes of a plan, and the proofs of its legs in them, made of the motion as it is driven.
#include "leeway/sequence/sequence.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::sequence
{
namespace
{

using State = std::vector<double>;

State endOf( const motions::Segment& segment )
{
	const auto count = static_cast<std::ptrdiff_t>( segment.points.size() / ( segment.degree + 1 ) );
	return { segment.points.end() - count, segment.points.end() };
}

/// @throws io::Error unless the robot rests at this end of a segment
void requireRest( const motions::Segment& segment, bool at_end, const Leg& leg )
{
	const auto count = static_cast<std::ptrdiff_t>( segment.points.size() / ( segment.degree + 1 ) );
	const auto first = segment.points.begin(), last = segment.points.end() - count;
	if ( !( at_end ? std::equal( last - count, last, last ) : std::equal( first, first + count, first + count ) ) )
	{
		throw io::Error( leg.scene.file, leg.element, "the robot does not rest where the scene changes",
		    "give the segments of the plan as they are" );
	}
}

/// A state that is held for no time.
motions::Segment held( const State& state, double time )
{
	motions::Segment segment{ time, 0, 1, state };
	segment.points.insert( segment.points.end(), state.begin(), state.end() );
	return segment;
}

} // namespace

std::vector<Chapter> chaptersOf( const io::World& world, const std::vector<Leg>& legs, const Result& plan,
    const std::vector<motions::Segment>& segments, const std::vector<double>& start )
{
	std::vector<Chapter> chapters;
	std::shared_ptr<const io::World> now = std::make_shared<io::World>( world );
	State state = start.empty() ? io::startState( *now->problem() ) : start;
	const motions::Segment* last = nullptr; // driven so far
	for ( std::size_t i = 0; i < plan.legs.size(); ++i )
	{
		const Motion& leg = plan.legs[i];
		const auto first = segments.begin() + static_cast<std::ptrdiff_t>( leg.first );
		const auto end = first + static_cast<std::ptrdiff_t>( leg.count );
		const bool changes = !legs[i].scene.empty();
		if ( changes || i == 0 )
		{
			if ( changes && leg.count > 0 )
			{
				requireRest( *first, false, legs[i] );
			}
			if ( changes && last != nullptr )
			{
				requireRest( *last, true, legs[i] );
			}
			now = changes ? io::changed( *now, legs[i].scene, state ) : now;
			chapters.push_back( { now->problem(), i, 0, { held( state, leg.begin ) } } );
		}
		Chapter& chapter = chapters.back();
		++chapter.legs;
		if ( leg.count > 0 )
		{
			chapter.segments.back().seconds == 0 ? chapter.segments.clear() : void();
			chapter.segments.insert( chapter.segments.end(), first, end );
			last = &*( end - 1 );
			state = endOf( *last );
		}
	}
	return chapters;
}

motions::TrajectoryAudit auditChapters( const io::RobotModel& robot, const std::vector<Chapter>& chapters,
    const std::string& name, const motions::TrajectorySettings& settings )
{
	motions::TrajectoryAudit whole;
	for ( const Chapter& chapter : chapters )
	{
		motions::append( whole, motions::auditTrajectory( *chapter.problem, robot, name, chapter.segments, settings ) );
	}
	return whole;
}

std::vector<std::vector<motions::ConstraintProof>> proveLegs( const std::vector<Chapter>& chapters,
    const io::PathConstraints& sequence, const Result& plan, const std::vector<motions::Segment>& segments )
{
	std::vector<std::vector<motions::ConstraintProof>> proofs( plan.legs.size() );
	for ( const Chapter& chapter : chapters )
	{
		for ( std::size_t i = chapter.leg; i < chapter.leg + chapter.legs; ++i )
		{
			const io::PathConstraints& own = sequence.items[i].path;
			const Motion& leg = plan.legs[i];
			if ( !own.empty() && leg.count > 0 )
			{
				const auto first = segments.begin() + static_cast<std::ptrdiff_t>( leg.first );
				proofs[i] = motions::proveConstraints(
				    *chapter.problem, own, { first, first + static_cast<std::ptrdiff_t>( leg.count ) }, {} );
			}
		}
	}
	return proofs;
}

} // namespace leeway::sequence
