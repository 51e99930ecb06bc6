// SPDX-License-Identifier: BSD-3-Clause
// Files of models and problems: URDF, SRDF, planning scenes, requests, margins and paddings, worlds, tables, paths.
#include "fuzz.hpp"

#include "motions/csv.hpp"
#include "leeway/motions/path_file.hpp"
#include "leeway/motions/schedule.hpp"
#include "leeway/motions/steps_file.hpp"
#include "leeway/motions/trajectory_file.hpp"

#include <algorithm>
#include <cmath>

namespace fuzz
{

namespace
{

namespace io = leeway::io;

/// A state check and an edge at the values that the model itself gives: a loaded model has to be usable.
void useProblem( const io::Problem& problem )
{
	const lw_checker* checker = problem.checker.get();
	const leeway::Query query = leeway::makeQuery( checker );
	std::vector<double> q = io::startState( problem );
	expect( q.size() == lw_checker_variable_count( checker ), "a start state has all variables" );
	lw_state_result result;
	const lw_status status = lw_checker_state( checker, query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result );
	expect( status == LW_OK || result.verdict == LW_VERDICT_UNKNOWN, "an error has no verdict" );
	(void)io::limitViolations( problem, q );
}

} // namespace

void urdf( Input input )
{
	putMeshes();
	const std::string file = put( "input.urdf", input );
	reads(
	    [&]
	    {
		    io::LoadOptions options;
		    options.use_visual = input.size() % 2 == 0;
		    const io::RobotModel model = io::loadRobot( file, "", options );
		    const io::Problem problem = io::buildProblem( model, {} );
		    useProblem( problem );
	    } );
}

void mjcf( Input input )
{
	putMeshes();
	putOnce( "part.xml", "<x><body name=\"p\"><geom size=\"1\"/></body></x>" );
	const std::string file = put( "input.xml", "<mujoco>" + std::string( input ) + "</mujoco>" );
	reads(
	    [&]
	    {
		    io::LoadOptions options;
		    options.use_visual = input.size() % 2 == 0;
		    const io::RobotModel model = io::loadRobot( file, "", options );
		    const io::Problem problem = io::buildProblem( model, {} );
		    useProblem( problem );
		    for ( const io::GroupState& state : model.group_states )
		    {
			    expect( model.findGroup( state.group ) != nullptr, "a state has its group" );
		    }
	    } );
}

void srdf( Input input )
{
	const io::RobotModel& plain = fixedRobot();
	const std::string file = put( "input.srdf", input );
	reads(
	    [&]
	    {
		    const io::RobotModel model = io::loadRobot( plain.urdf_file, file );
		    for ( const io::Group& group : model.groups )
		    {
			    io::ProblemOptions options;
			    options.group = group.name;
			    if ( reads( [&] { useProblem( io::buildProblem( model, options ) ); } ) )
			    {
				    break; // the others are of the same joints
			    }
		    }
		    const io::WrittenSrdf written = io::writeSrdf( model, { { "a", "c", "Never" } } );
		    const std::string again = put( "written.srdf", written.text );
		    expect(
		        reads( [&] { (void)io::loadRobot( plain.urdf_file, again ); } ), "an SRDF that was written can be read" );
	    } );
}

void scene( Input input )
{
	const io::RobotModel& robot = fixedRobot();
	putOnce( "map.txt", "0 1\n0 0.5\n" );
	putOnce( "cloud.pcd", "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
	                      "DATA ascii\n0 0 0\n1 1 1\n" );
	const std::string file = put( "input.yaml", input );
	reads(
	    [&]
	    {
		    const io::SceneModel model = io::loadScene( file );
		    io::ProblemOptions options;
		    options.scene = &model;
		    useProblem( io::buildProblem( robot, options ) );
	    } );
}

void request( Input input )
{
	const io::RobotModel& robot = fixedRobot();
	const std::string file = put( "input.yaml", input );
	reads(
	    [&]
	    {
		    const io::Request asked = io::loadRequest( file );
		    io::ProblemOptions options;
		    options.request = &asked;
		    options.group = asked.group;
		    const io::Problem problem = io::buildProblem( robot, options );
		    useProblem( problem );
		    for ( double value : io::goalState( problem, asked ) )
		    {
			    expect( std::isfinite( value ), "a goal is finite" );
		    }
	    } );
}

void settings( Input input )
{
	const io::RobotModel& robot = fixedRobot();
	const std::string file = put( "input.yaml", input );
	io::ProblemOptions options;
	const bool margins = reads( [&] { options.margins = io::loadMargins( file ); } );
	const bool padding = reads( [&] { options.padding = io::loadPadding( file ); } );
	if ( margins || padding )
	{
		reads( [&] { useProblem( io::buildProblem( robot, options ) ); } );
	}
}

void world( Input input )
{
	(void)fixedRobot(); // its files
	putOnce( "motion.yaml", "joint_names: [j]\npoints:\n  - {positions: [0.1], time_from_start: 0}\n"
	                        "  - {positions: [0.2], velocities: [0], time_from_start: 1}\n" );
	const std::string file = put( "input.yaml", input );
	reads(
	    [&]
	    {
		    const io::WorldModel model = io::loadWorld( file );
		    const io::Problem problem = io::buildProblem( model.robot, io::worldProblem( model ) );
		    useProblem( problem );
		    leeway::motions::Schedule schedule( model, problem );
		    leeway::motions::ScheduleSettings settings;
		    settings.to = std::min( 1.0, schedule.duration() );
		    settings.edge.close_windows = 16;
		    const leeway::motions::ScheduleAudit audit = leeway::motions::auditSchedule( schedule, settings );
		    expect( audit.verdict != LW_VERDICT_UNKNOWN, "a schedule that was asked has a verdict" );
	    } );
}

void csv( Input input )
{
	const std::string file = put( "input.csv", input );
	reads(
	    [&]
	    {
		    const leeway::motions::CsvTable table = leeway::motions::readCsv( file );
		    for ( std::size_t row = 0; row < table.rows.size(); ++row )
		    {
			    for ( std::size_t column = 0; column < table.header.size(); ++column )
			    {
				    reads( [&] { expect( std::isfinite( table.value( row, column ) ), "a value of a table is finite" ); } );
			    }
		    }
	    } );
}

void path( Input input )
{
	const std::string file = put( "input.yaml", input );
	reads(
	    [&]
	    {
		    const leeway::motions::PathFile first = leeway::motions::readPath( file );
		    for ( const std::vector<double>& point : first.points )
		    {
			    expect( point.size() == first.joint_names.size(), "a point has a value for each joint" );
		    }
		    const std::string again = put( "written.yaml", leeway::motions::writePath( first ) );
		    const leeway::motions::PathFile second = leeway::motions::readPath( again );
		    expect( second.points == first.points && second.joint_names == first.joint_names && second.min_d == first.min_d,
		        "a path that was written is read again" );
	    } );
	for ( const std::string& name : { file, put( "input.csv", input ) } )
	{
		reads(
		    [&]
		    {
			    for ( const leeway::motions::TrajectoryFile& trajectory : leeway::motions::readTrajectories( name ) )
			    {
				    double before = -1;
				    for ( const leeway::motions::TrajectoryPoint& point : trajectory.points )
				    {
					    const std::size_t count = trajectory.joint_names.size();
					    expect( point.positions.size() == count && point.velocities.size() % count == 0 &&
					                point.accelerations.size() % count == 0,
					        "a point of a trajectory has a value for each joint" );
					    expect( point.time > before, "times of a trajectory increase" );
					    before = point.time;
				    }
			    }
		    } );
	}
	reads( [&] { leeway::motions::readJointLimits( file ); } );
}

void steps( Input input )
{
	const std::string file = put( "input.yaml", input );
	reads(
	    [&]
	    {
		    bool moves = false;
		    for ( const leeway::motions::Step& step : leeway::motions::readSteps( file ) )
		    {
			    using Kind = leeway::motions::Step::Kind;
			    const bool with_link = step.kind == Kind::attach || step.kind == Kind::allow || step.kind == Kind::forbid;
			    moves = moves || step.kind == Kind::trajectory;
			    expect( ( step.kind == Kind::trajectory ) == !step.file.empty(),
			        "a step with a trajectory has its file, no other has one" );
			    expect( step.kind == Kind::trajectory || !step.object.empty(), "a change of the world names an object" );
			    expect( with_link == !step.link.empty(), "an object that is attached or allowed to touch has a link" );
		    }
		    expect( moves, "steps have a trajectory" );
	    } );
}

} // namespace fuzz
