// SPDX-License-Identifier: BSD-3-Clause
// leeway.Inverse: inverse kinematics of one frame, for batches of poses.
#include "objects.hpp"

#include "leeway/ik/inverse.hpp"

#include <nanobind/stl/string.h>

#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

constexpr std::size_t block_of_poses = 8;

/// leeway.Inverse: immutable, one solver for each thread that works.
struct PyInverse
{
	PyInverse( const PyChecker& of, const io::Frame& tip_frame, const io::Frame& base_frame )
	    : checker( of ), tip( tip_frame ), base( base_frame )
	{
		solvers.push_back( take() );
	}
	std::unique_ptr<ik::Inverse> take()
	{
		{
			const std::lock_guard<std::mutex> lock( mutex );
			if ( !solvers.empty() )
			{
				std::unique_ptr<ik::Inverse> solver = std::move( solvers.back() );
				solvers.pop_back();
				return solver;
			}
		}
		return std::make_unique<ik::Inverse>( *checker.model, *checker.problem, tip, base );
	}
	void giveBack( std::unique_ptr<ik::Inverse> solver )
	{
		const std::lock_guard<std::mutex> lock( mutex );
		solvers.push_back( std::move( solver ) );
	}

	const PyChecker checker;
	const io::Frame tip, base;
	std::mutex mutex;
	std::vector<std::unique_ptr<ik::Inverse>> solvers;
};

/// Start states: one for each pose, or one for all; none: that of the checker.
struct Starts
{
	Starts( const nb::object& given, const PyChecker& checker, std::size_t poses )
	{
		if ( given.is_none() )
		{
			return;
		}
		if ( !nb::try_cast( given, numbers ) )
		{
			throw nb::value_error( "start: is no array of numbers" );
		}
		rows = rowsOf( numbers, checker.variables(), "start", "variables of the group" );
		if ( !rows.single && rows.count != poses )
		{
			const std::string text = "start: " + std::to_string( rows.count ) + " states for " + std::to_string( poses ) +
			                         " poses; give one for each, or one for all";
			throw nb::value_error( text.c_str() );
		}
		for ( std::size_t i = 0; i < rows.count; ++i )
		{
			for ( std::size_t v = 0; v < rows.width; ++v )
			{
				if ( !std::isfinite( rows[i][v] ) )
				{
					const std::string text = "start[" + std::to_string( i ) + "]: entry " + std::to_string( v ) +
					                         " is not finite; correct the state";
					throw nb::value_error( text.c_str() );
				}
			}
		}
	}
	const double* operator[]( std::size_t i ) const { return rows.data == nullptr ? nullptr : rows[rows.single ? 0 : i]; }
	Doubles numbers;
	Rows rows;
};

nb::object arraysOf( const PyChecker& checker, const std::vector<ik::InverseStates>& all, bool clearances )
{
	const std::size_t dof = checker.variables();
	const NewArray<std::int64_t> offsets( { all.size() + 1 } );
	const NewArray<std::uint8_t> failures( { all.size() } );
	const NewArray<double> metres( { all.size() } ), radians( { all.size() } );
	nb::list messages;
	offsets.data[0] = 0;
	for ( std::size_t i = 0; i < all.size(); ++i )
	{
		const ik::InverseStates& found = all[i];
		offsets.data[i + 1] = offsets.data[i] + static_cast<std::int64_t>( found.states.size() );
		failures.data[i] = static_cast<std::uint8_t>( found.failure );
		metres.data[i] = found.metres;
		radians.data[i] = found.radians;
		messages.append( found.failure == ik::Failure::NONE ? std::string() : found.problem + "; " + found.remedy );
	}
	const auto count = static_cast<std::size_t>( offsets.data[all.size()] );
	const NewArray<double> states( { count, dof } ), lower( { clearances ? count : 0 } ),
	    upper( { clearances ? count : 0 } );
	std::size_t k = 0;
	for ( const ik::InverseStates& found : all )
	{
		for ( const ik::InverseState& state : found.states )
		{
			std::copy( state.q.begin(), state.q.end(), states.data + k * dof );
			if ( clearances )
			{
				lower.data[k] = state.lower;
				upper.data[k] = state.upper;
			}
			++k;
		}
	}
	return result( "InverseStates",
	    nb::make_tuple( offsets.object, states.object, clearances ? lower.object : nb::none(),
	        clearances ? upper.object : nb::none(), failures.object, metres.object, radians.object, messages ) );
}

nb::object solve( PyInverse& self, const Doubles& poses, const nb::object& start, const Whole& count,
    const nb::object& check, double min_d, double max_d, bool turns, const Whole& searches, double patience, double apart,
    const Whole& seed, const Whole& threads )
{
	const std::vector<lw_transform> wanted = posesOf( poses, "poses" );
	const Starts starts( start, self.checker, wanted.size() );
	ik::InverseOptions options;
	options.states = count.in( "count", 1, std::numeric_limits<std::uint32_t>::max() );
	options.searches = searches.in( "searches", 1, std::numeric_limits<std::uint32_t>::max() );
	options.patience = patience;
	options.apart = apart;
	options.seed = seed.seed();
	options.turns = turns;
	options.clearances = !check.is_none();
	options.flags = options.clearances ? checkFlags( nb::cast<std::string>( check ) ) : LW_CHECK_BOTH;
	options.min_d = min_d;
	options.max_d = max_d;
	std::vector<ik::InverseStates> found( wanted.size() );
	inBlocks( *self.checker.queries, wanted.size(), block_of_poses, threads.threads(),
	    [&]( lw_query* query, std::size_t begin, std::size_t end )
	    {
		    std::unique_ptr<ik::Inverse> solver = self.take();
		    for ( std::size_t i = begin; i < end; ++i )
		    {
			    found[i] = solver->solve( wanted[i], starts[i], options, query );
		    }
		    self.giveBack( std::move( solver ) );
	    } );
	return arraysOf( self.checker, found, options.clearances );
}

} // namespace

void bindInverses( nb::module_& module )
{
	nb::class_<PyInverse> type( module, "Inverse",
	    "Inverse kinematics of one frame: the states of a checker's group in which a link's frame has a pose, one state or all branches.\n"
	    "Any joints but floating ones, in any number. Threads may share it. Goals with tolerances: Checker.goal_states()." );
	type.def(
	    "__init__",
	    []( PyInverse* self, const PyChecker& checker, const std::string& link, const nb::object& tip,
	        const std::string& frame )
	    {
		    const io::Problem& problem = *checker.problem;
		    io::Frame tip_frame = io::findFrame( problem, link, "Inverse", "link" );
		    const lw_transform offset = poseOrIdentity( tip, "tip" );
		    tip_frame.pose = lw_transform_multiply( &tip_frame.pose, &offset );
		    new ( self ) PyInverse( checker, tip_frame, io::findFrame( problem, frame, "Inverse", "frame" ) );
	    },
	    "checker"_a, "link"_a, nb::kw_only(), "tip"_a = nb::none(), "frame"_a = "",
	    nb::sig(
	        "def __init__(self, checker: Checker, link: str, *, tip: numpy.typing.ArrayLike | None = None, frame: str = '') -> None" ),
	    "link: whose frame has the poses, or an attached object; tip: a pose in it, None = its origin. frame: of the poses, a link that may\n"
	    "move itself or an object; empty: the planning frame. Raises InputError if no joint of the group moves the one in the other." );
	const ik::InverseOptions defaults;
	type.def( "solve", &solve, "poses"_a, "start"_a = nb::none(), nb::kw_only(), "count"_a.none() = defaults.states,
	    "check"_a = nb::none(), "min_d"_a = defaults.min_d, "max_d"_a = defaults.max_d, "turns"_a = defaults.turns,
	    "searches"_a.none() = defaults.searches, "patience"_a = defaults.patience, "apart"_a = defaults.apart,
	    "seed"_a.none() = defaults.seed, "threads"_a.none() = 1,
	    nb::sig(
	        "def solve(self, poses: numpy.typing.ArrayLike, start: numpy.typing.ArrayLike | None = None, *, count: int = 16, "
	        "check: str | None = None, min_d: float = 0.0, max_d: float = float('inf'), turns: bool = False, "
	        "searches: int = 500, patience: float = 8.0, apart: float = 0.01, seed: int = 1, threads: int = 1) -> "
	        "leeway.results.InverseStates" ),
	    "States that have the poses to 1e-9 m and 1e-9 rad, by the same kinematics as Robot.fk(), within the joint limits.\n\n"
	    "poses: float64 [n, 7], x y z qx qy qz qw; [n, 4, 4]; or one of them. start: float64 [n, dof] or [dof], None = the checker's\n"
	    "start: searches begin there, and the nearest state to it comes first. count: states for each pose at most; 1 ends with the first, to\n"
	    "which the start leads if it leads to any. Up to six joints: all branches that random starts find; more: samples of the family.\n"
	    "check: \"both\", \"environment\" or \"self\" certifies clearances (metres, exact between min_d and max_d) and puts states above min_d\n"
	    "first. turns: joints with limits a whole turn apart give a state for each turn, else the one nearest to the start. searches:\n"
	    "descents for each pose, at most; patience: how long they go on without a further state; apart: two states nearer in every\n"
	    "variable are one. Equal seeds give equal states, whatever the batch and the threads (0 = one per core). Returns InverseStates.\n"
	    "Raises ValueError for a pose or start that is not finite, or a quaternion of 0." );
	type.def( "__reduce__", &refusePickle );
}

} // namespace leeway::python
