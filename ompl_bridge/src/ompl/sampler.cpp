// SPDX-License-Identifier: BSD-3-Clause
// Samples that move out of obstacles. Papers: Boor, Overmars, van der Stappen, The Gaussian sampling strategy (ICRA 1999); Wilmarth, Amato,
// Stiller, MAPRM (ICRA 1999); Hsu, Jiang, Reif, Sun, The bridge test (ICRA 2003).
#include "leeway/ompl/sampler.hpp"

#include "leeway/near.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

namespace
{

constexpr std::uint32_t most_rows = 12;
constexpr unsigned halvings = 7;      // of the way between a free state and one in contact
constexpr unsigned bridge_parts = 4;  // of the way between two states in contact
constexpr double beyond = 1.1;        // of the wanted clearance: steps end where it is kept, not where it is attained
constexpr double longest_step = 0.25; // of the radius around states in contact
constexpr double damping = 0.02;      // of the rows' mean square
constexpr int solver_rounds = 8;

PushOptions checkedOptions( const PushOptions& options )
{
	const auto need = []( bool condition, const char* sentence )
	{
		if ( !condition )
		{
			throw std::invalid_argument( std::string( "leeway::ompl::PushingSampler: " ) + sentence );
		}
	};
	need( options.clearance > 0 && std::isfinite( options.clearance ), "clearance must be finite and above 0" );
	need( options.steps >= 1, "steps must be at least 1" );
	need( options.radius > 0 && std::isfinite( options.radius ), "radius must be finite and above 0" );
	return options;
}

double dot( const double* a, const double* b, std::size_t size )
{
	double sum = 0;
	for ( std::size_t i = 0; i < size; ++i )
	{
		sum += a[i] * b[i];
	}
	return sum;
}

} // namespace

PushingSampler::PushingSampler(
    const ob::SpaceInformation* si, std::shared_ptr<const Engine> engine, const PushOptions& options )
    : ob::ValidStateSampler( si ), m_engine( std::move( engine ) ), m_options( checkedOptions( options ) ),
      m_sampler( si->allocStateSampler() ), m_radius( options.radius * si->getStateSpace()->getMaximumExtent() )
{
	if ( si->getStateSpace() != m_engine->adapter().space() )
	{
		throw std::invalid_argument( "leeway::ompl::PushingSampler: the engine was made with another space; give that one" );
	}
	name_ = "leeway pushing";
	m_q.resize( m_engine->adapter().size() );
	m_move.resize( m_q.size() );
	m_rows.resize( most_rows * m_q.size() );
}

bool PushingSampler::sample( ob::State* state )
{
	for ( unsigned attempt = 0; attempt < attempts_; ++attempt )
	{
		m_sampler->sampleUniform( state );
		if ( push( state ) )
		{
			return true;
		}
	}
	return false;
}

bool PushingSampler::sampleNear( ob::State* state, const ob::State* near, double distance )
{
	for ( unsigned attempt = 0; attempt < attempts_; ++attempt )
	{
		m_sampler->sampleUniformNear( state, near, distance );
		if ( push( state ) )
		{
			return true;
		}
	}
	return false;
}

bool PushingSampler::push( ob::State* state )
{
	bool was_in_contact = false;
	for ( unsigned i = 0; i <= m_options.steps; ++i )
	{
		Step outcome = Step::STUCK;
		{
			const Engine::Lease lease( *m_engine ); // not held while the validity checker takes one
			if ( !lease )
			{
				return false;
			}
			m_engine->adapter().toVector( state, m_q.data() );
			outcome = step( lease, m_q );
		}
		if ( outcome == Step::CONTACT )
		{
			if ( was_in_contact || !leaveContact( state ) )
			{
				return false;
			}
			was_in_contact = true;
			continue;
		}
		if ( outcome != Step::MOVED || i == m_options.steps )
		{
			break;
		}
		m_engine->adapter().fromVector( m_q.data(), state );
		si_->enforceBounds( state );
	}
	return si_->isValid( state );
}

/// One step along the derivatives of the near pairs: the damped least motion that gives each of them its clearance, by a few rounds of
/// projection onto one after the other (Kaczmarz), which need no matrix.
PushingSampler::Step PushingSampler::step( const Engine::Lease& lease, std::vector<double>& q )
{
	const double wanted = beyond * ( m_engine->options().min_d + m_options.clearance );
	lw_near_def def = lw_near_def_default();
	def.flags = m_engine->options().flags;
	def.distance = wanted;
	def.alpha = 0.05;
	def.derivatives = m_rows.data();
	lw_near_pair pairs[most_rows];
	std::uint32_t count = 0;
	if ( lw_checker_near( lease.checker(), lease.query(), q.data(), &def, pairs, most_rows, &count ) != LW_OK )
	{
		return Step::STUCK;
	}
	count = std::min( count, most_rows );
	const std::size_t size = q.size();
	double squares[most_rows] = {}, mean = 0;
	bool enough = true;
	for ( std::uint32_t r = 0; r < count; ++r )
	{
		if ( pairs[r].direction == LW_DIRECTION_NONE )
		{
			return Step::CONTACT;
		}
		squares[r] = dot( m_rows.data() + r * size, m_rows.data() + r * size, size );
		mean += squares[r] / count;
		enough = enough && pairs[r].clearance.lower > wanted / beyond;
	}
	if ( enough || !( mean > 0 ) )
	{
		return enough ? Step::FAR : Step::STUCK;
	}
	std::fill( m_move.begin(), m_move.end(), 0 );
	for ( int round = 0; round < solver_rounds; ++round )
	{
		for ( std::uint32_t r = 0; r < count; ++r )
		{
			const double* row = m_rows.data() + r * size;
			const double need = wanted - pairs[r].clearance.lower - dot( row, m_move.data(), size );
			const double scale = need > 0 ? 0.7 * need / ( squares[r] + damping * mean ) : 0;
			for ( std::size_t i = 0; i < size; ++i )
			{
				m_move[i] += scale * row[i];
			}
		}
	}
	const double length = std::sqrt( dot( m_move.data(), m_move.data(), size ) ), most = longest_step * m_radius;
	const double share = length > most ? most / length : 1;
	for ( std::size_t i = 0; i < size; ++i )
	{
		q[i] += share * m_move[i];
	}
	return length > 0 ? Step::MOVED : Step::STUCK;
}

/// States around a state in contact: a free one between two in contact is in a narrow place, and preferred. Else the way to the first free one
/// is halved down to the surface.
bool PushingSampler::leaveContact( ob::State* state )
{
	ob::State *other = si_->allocState(), *middle = si_->allocState(), *free = si_->allocState();
	const ob::StateSpacePtr& space = si_->getStateSpace();
	bool has_free = false, between = false;
	for ( unsigned i = 0; i < m_options.tries && !between; ++i )
	{
		m_sampler->sampleUniformNear( other, state, m_radius );
		if ( si_->isValid( other ) )
		{
			has_free ? void() : si_->copyState( free, other );
			has_free = true;
			continue;
		}
		for ( unsigned k = 1; k < bridge_parts && !between; ++k )
		{
			space->interpolate( state, other, double( k ) / bridge_parts, middle );
			between = si_->isValid( middle );
		}
	}
	if ( between )
	{
		si_->copyState( state, middle );
	}
	else if ( has_free )
	{
		for ( unsigned i = 0; i < halvings; ++i )
		{
			space->interpolate( free, state, 0.5, middle );
			si_->copyState( si_->isValid( middle ) ? free : state, middle );
		}
		si_->copyState( state, free );
	}
	for ( ob::State* own : { other, middle, free } )
	{
		si_->freeState( own );
	}
	return between || has_free;
}

ob::ValidStateSamplerAllocator pushingSamplers( std::shared_ptr<const Engine> engine, const PushOptions& options )
{
	checkedOptions( options );
	return [engine = std::move( engine ), options]( const ob::SpaceInformation* si ) -> ob::ValidStateSamplerPtr
	{ return std::make_shared<PushingSampler>( si, engine, options ); };
}

} // namespace leeway::ompl
