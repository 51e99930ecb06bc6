// SPDX-License-Identifier: BSD-3-Clause
// Bad input: one line that names file, element and remedy; exit status 2; nothing left behind.
#include "cli_fixture.hpp"

#include <algorithm>

namespace
{

struct Edit
{
	std::string file, from, to; ///< `from` empty: the file's text becomes `to`; "delete" as `from`: the file is removed
};

struct Case
{
	std::string name;
	std::vector<Edit> edits;
	std::string subcommand;
	std::vector<std::string> arguments;
	std::vector<std::string> words; ///< that the message must have
};

std::ostream& operator<<( std::ostream& stream, const Case& value )
{
	return stream << value.name;
}

const std::vector<std::string> check_arguments = { "--group", "arm", "--states", "states.csv", "--out", "out.csv" };
const std::vector<std::string> edge_arguments = { "--group", "arm", "--edges", "edges.csv", "--out", "out.csv" };
const std::vector<std::string> plan_arguments = {
    "--request", "request.yaml", "--out", "out.csv", "--report", "report.json" };
const std::vector<std::string> audit_arguments = { "--group", "arm", "--path", "path.yaml", "--report", "report.json" };

std::vector<std::string> with( std::vector<std::string> arguments, const std::vector<std::string>& more )
{
	arguments.insert( arguments.end(), more.begin(), more.end() );
	return arguments;
}

const std::string good_path = "joint_names: [shoulder, elbow]\npoints:\n  - positions: [0, 0]\n";
const std::string unit = "orientation: [0, 0, 0, 1]";

std::vector<Case> modelCases()
{
	return {
	    { "RobotMissing", { { "arm.urdf", "delete", "" } }, "check", check_arguments, { "arm.urdf" } },
	    { "RobotNotXml", { { "arm.urdf", "", "<robot name='x'><link" } }, "check", check_arguments, { "arm.urdf" } },
	    { "RobotEmpty", { { "arm.urdf", "", "" } }, "check", check_arguments, { "arm.urdf" } },
	    { "RobotMeshMissing", { { "fore.stl", "delete", "" } }, "check", check_arguments, { "fore.stl", "fore" } },
	    { "RobotMeshEmpty", { { "fore.stl", "", "solid box\nendsolid box\n" } }, "check", check_arguments, { "fore.stl" } },
	    { "RobotMeshGarbage", { { "fore.stl", "", "this is no mesh" } }, "check", check_arguments, { "fore.stl" } },
	    { "RobotMeshNan", { { "fore.stl", "vertex 0.4", "vertex nan" } }, "check", check_arguments, { "fore.stl" } },
	    { "RobotOriginNan", { { "arm.urdf", "0.4 0 0", "nan 0 0" } }, "check", check_arguments, { "arm.urdf", "elbow" } },
	    { "RobotBoxInfinite", { { "arm.urdf", "0.2 0.2 0.1", "inf 0.2 0.1" } }, "check", check_arguments,
	        { "arm.urdf", "base" } },
	    { "RobotBoxNegative", { { "arm.urdf", "0.2 0.2 0.1", "-0.2 0.2 0.1" } }, "check", check_arguments,
	        { "arm.urdf", "base" } },
	    { "RobotAxisZero", { { "arm.urdf", "axis xyz=\"0 0 1\"", "axis xyz=\"0 0 0\"" } }, "check", check_arguments,
	        { "arm.urdf", "shoulder" } },
	    { "RobotLimitsSwapped", { { "arm.urdf", "lower=\"-2\" upper=\"2\"", "lower=\"2\" upper=\"-2\"" } }, "check",
	        check_arguments, { "arm.urdf", "shoulder" } },
	    { "RobotParentUnknown", { { "arm.urdf", "<parent link=\"upper\"/>", "<parent link=\"nothing\"/>" } }, "check",
	        check_arguments, { "arm.urdf", "nothing" } },
	    { "RobotWithoutCollisionGeometry",
	        { { "arm.urdf", "",
	              "<robot name='bare'><link name='a'/><link name='b'/><joint name='j' type='continuous'>"
	              "<parent link='a'/><child link='b'/></joint></robot>" },
	            { "arm.srdf", "", "<robot name='bare'><group name='arm'><joint name='j'/></group></robot>" } },
	        "info", { "--group", "arm" }, { "arm.urdf", "collision" } },
	    { "SrdfMissing", { { "arm.srdf", "delete", "" } }, "check", check_arguments, { "arm.srdf" } },
	    { "SrdfNotXml", { { "arm.srdf", "", "<robot" } }, "check", check_arguments, { "arm.srdf" } },
	    { "SrdfJointUnknown", { { "arm.srdf", "<joint name=\"elbow\"/>", "<joint name=\"knee\"/>" } }, "check",
	        check_arguments, { "arm.srdf", "knee" } },
	    { "GroupUnknown", {}, "check", { "--group", "leg", "--states", "states.csv", "--out", "out.csv" }, { "leg" } },
	    { "SceneMissing", { { "scene.yaml", "delete", "" } }, "check", check_arguments, { "scene.yaml" } },
	    { "SceneNotYaml", { { "scene.yaml", "", "world: [unclosed" } }, "check", check_arguments, { "scene.yaml" } },
	    { "SceneQuaternionZero", { { "scene.yaml", unit, "orientation: [0, 0, 0, 0]" } }, "check", check_arguments,
	        { "scene.yaml", "wall", "quaternion" } },
	    { "SceneQuaternionNan", { { "scene.yaml", unit, "orientation: [0, 0, 0, .nan]" } }, "check", check_arguments,
	        { "scene.yaml", "wall" } },
	    { "ScenePositionInfinite", { { "scene.yaml", "[1.0, 0, 0]", "[.inf, 0, 0]" } }, "check", check_arguments,
	        { "scene.yaml", "wall" } },
	    { "SceneBoxZero", { { "scene.yaml", "[0.2, 2, 2]", "[0, 2, 2]" } }, "check", check_arguments,
	        { "scene.yaml", "wall" } },
	    { "SceneShapeUnknown", { { "scene.yaml", "type: box", "type: torus" } }, "check", check_arguments,
	        { "scene.yaml", "wall", "torus" } },
	    { "SceneMeshMissing",
	        { { "scene.yaml", "",
	            "world:\n  collision_objects:\n    - id: pot\n      meshes:\n        - resource: pot.stl\n"
	            "      mesh_poses:\n        - position: [0, 0, 0]\n          orientation: [0, 0, 0, 1]\n" } },
	        "check", check_arguments, { "scene.yaml", "pot" } },
	    { "SceneFrameUnknown", { { "scene.yaml", "id: wall", "id: wall\n      header: {frame_id: nowhere}" } }, "check",
	        check_arguments, { "nowhere" } },
	};
}

std::vector<Case> tableCases()
{
	return {
	    { "StatesMissing", { { "states.csv", "delete", "" } }, "check", check_arguments, { "states.csv" } },
	    { "StatesEmpty", { { "states.csv", "", "" } }, "check", check_arguments, { "states.csv", "empty" } },
	    { "StatesNan", { { "states.csv", "0.5,0.5", "0.5,nan" } }, "check", check_arguments,
	        { "states.csv", "line 3", "elbow" } },
	    { "StatesInfinite", { { "states.csv", "0.5,0.5", "-inf,0.5" } }, "check", check_arguments,
	        { "states.csv", "line 3", "shoulder" } },
	    { "StatesTooLarge", { { "states.csv", "0.5,0.5", "1e999,0.5" } }, "check", check_arguments,
	        { "line 3", "shoulder" } },
	    { "StatesText", { { "states.csv", "0.5,0.5", "0.5,half" } }, "check", check_arguments,
	        { "line 3", "elbow", "half" } },
	    { "StatesTrailingText", { { "states.csv", "0.5,0.5", "0.5,0.5rad" } }, "check", check_arguments,
	        { "line 3", "elbow" } },
	    { "StatesCellMissing", { { "states.csv", "0.5,0.5", "0.5," } }, "check", check_arguments,
	        { "line 3", "elbow", "missing" } },
	    { "StatesShortRow", { { "states.csv", "0.5,0.5", "0.5" } }, "check", check_arguments, { "line 3", "1 cell " } },
	    { "StatesNoJoint", { { "states.csv", "", "a,b\n1,2\n" } }, "check", check_arguments, { "states.csv", "no joint" } },
	    { "StatesColumnTwice", { { "states.csv", "", "elbow,elbow\n1,2\n" } }, "check", check_arguments,
	        { "elbow", "twice" } },
	    { "EdgesWithoutTo", { { "edges.csv", "", "from:shoulder,from:elbow,to:shoulder\n0,0,1\n" } }, "edge", edge_arguments,
	        { "edges.csv", "to:elbow" } },
	    { "EdgesWithoutFrom", { { "edges.csv", "", "from:shoulder,to:elbow,to:shoulder\n0,0,1\n" } }, "edge", edge_arguments,
	        { "edges.csv", "from:elbow" } },
	    { "EdgesNan", { { "edges.csv", "-1,0,1,0", "-1,0,nan,0" } }, "edge", edge_arguments, { "line 2", "to:shoulder" } },
	    { "EdgesOfStates", { { "edges.csv", "", "shoulder,elbow\n0,0\n" } }, "edge", edge_arguments, { "from:" } },
	    { "PathMissing", {}, "audit", audit_arguments, { "path.yaml" } },
	    { "PathNotYaml", { { "path.yaml", "", "points: [" } }, "audit", audit_arguments, { "path.yaml", "YAML" } },
	    { "PathList", { { "path.yaml", "", "- 1\n- 2\n" } }, "audit", audit_arguments, { "path.yaml" } },
	    { "PathWithoutPoints", { { "path.yaml", "", "joint_names: [shoulder, elbow]\n" } }, "audit", audit_arguments,
	        { "points" } },
	    { "PathNan", { { "path.yaml", "", good_path + "  - positions: [0, .nan]\n" } }, "audit", audit_arguments,
	        { "points[1]" } },
	    { "PathShortPoint", { { "path.yaml", "", good_path + "  - positions: [0]\n" } }, "audit", audit_arguments,
	        { "points[1]" } },
	    { "PathOtherJoints", { { "path.yaml", "", "joint_names: [shoulder]\npoints:\n  - positions: [0]\n" } }, "audit",
	        audit_arguments, { "path.yaml", "elbow" } },
	    { "PathGroupUnknown", { { "path.yaml", "", "group: leg\n" + good_path } }, "audit",
	        { "--path", "path.yaml", "--report", "report.json" }, { "path.yaml", "leg", "--group" } },
	    { "PathMarginNegative", { { "path.yaml", "", "min_d: -1\n" + good_path } }, "audit", audit_arguments, { "min_d" } },
	};
}

std::vector<Case> requestCases()
{
	return {
	    { "RequestMissing", { { "request.yaml", "delete", "" } }, "plan", plan_arguments, { "request.yaml" } },
	    { "RequestNotYaml", { { "request.yaml", "", "{" } }, "plan", plan_arguments, { "request.yaml" } },
	    { "RequestTimeNegative", { { "request.yaml", "allowed_planning_time: 30", "allowed_planning_time: -30" } }, "plan",
	        plan_arguments, { "request.yaml", "allowed_planning_time" } },
	    { "RequestNan", { { "request.yaml", "[-1, 0]", "[.nan, 0]" } }, "plan", plan_arguments, { "request.yaml" } },
	    { "RequestGoalNan", { { "request.yaml", "position: 1\n", "position: .nan\n" } }, "plan", plan_arguments,
	        { "request.yaml" } },
	    { "RequestGroupUnknown", { { "request.yaml", "group_name: arm", "group_name: leg" } }, "plan", plan_arguments,
	        { "leg" } },
	    { "RequestGoalIncomplete", { { "request.yaml", "      - joint_name: elbow\n        position: 0\n", "" } }, "plan",
	        plan_arguments, { "request.yaml", "elbow" } },
	    { "RequestStartAboveLimit", { { "request.yaml", "[-1, 0]", "[-1, 2.9]" } }, "plan", plan_arguments,
	        { "start_state", "elbow", "above its limit" } },
	    { "RequestGoalBelowLimit", { { "request.yaml", "position: 1\n", "position: -2.5\n" } }, "plan", plan_arguments,
	        { "goal_constraints", "shoulder", "below its limit" } },
	    { "RequestStartInContact", { { "scene.yaml", "[1.0, 0, 0]", "[0.4, -0.6, 0]" } }, "plan", plan_arguments,
	        { "start_state", "wall", "contact" } },
	    { "RequestGoalTooClose", { { "request.yaml", "position: 1\n", "position: 0\n" } }, "plan",
	        with( plan_arguments, { "--min-d", "0.2" } ), { "goal_constraints", "fore - wall", "--min-d" } },
	    { "RequestStartStaticContact", { { "scene.yaml", "[1.0, 0, 0]", "[0, 0, -1.2]" } }, "plan", plan_arguments,
	        { "start_state", "base - wall", "cannot move" } },
	};
}

std::vector<Case> optionCases()
{
	return {
	    { "OptionMarginNegative", {}, "check", with( check_arguments, { "--min-d", "-0.1" } ), { "--min-d" } },
	    { "OptionMarginNan", {}, "check", with( check_arguments, { "--min-d", "nan" } ), { "--min-d" } },
	    { "OptionMaxBelowMin", {}, "check", with( check_arguments, { "--min-d", "0.1", "--max-d", "0.05" } ),
	        { "--max-d" } },
	    { "OptionAlphaOne", {}, "check", with( check_arguments, { "--alpha", "1" } ), { "--alpha" } },
	    { "OptionWhat", {}, "check", with( check_arguments, { "--what", "all" } ), { "--what" } },
	    { "OptionUnknown", {}, "check", with( check_arguments, { "--sideways" } ), { "--sideways" } },
	    { "OptionSlackZero", {}, "edge", with( edge_arguments, { "--slack", "0" } ), { "--slack" } },
	    { "OptionMaxDCertified", {}, "edge", with( edge_arguments, { "--max-d", "0.1" } ), { "--max-d" } },
	    { "OptionPlanner", {}, "plan", with( plan_arguments, { "--planner", "BKPIECEGood" } ),
	        { "BKPIECEGood", "RRTConnect", "BITstar" } },
	    { "OptionThreadsZero", {}, "plan", with( plan_arguments, { "--threads", "0" } ), { "--threads" } },
	    { "OptionThreadsTooMany", {}, "plan", with( plan_arguments, { "--planner", "pRRT", "--threads", "65" } ),
	        { "--threads", "64" } },
	    { "OptionPlannerParamUnknown", {}, "plan", with( plan_arguments, { "--planner-param", "reach=1" } ),
	        { "--planner-param", "reach", "range=" } },
	    { "OptionPlannerParamNoValue", {}, "plan", with( plan_arguments, { "--planner-param", "range" } ), { "no '='" } },
	    { "OptionPlannerParamNoNumber", {}, "plan", with( plan_arguments, { "--planner-param", "range=wide" } ),
	        { "wide" } },
	    { "OptionPlannerParamOutOfRange", {}, "plan", with( plan_arguments, { "--planner-param", "range=-1" } ),
	        { "-1", "range" } },
	    { "OptionSeedZero", {}, "plan", with( plan_arguments, { "--seed", "0" } ), { "--seed" } },
	    { "OptionTimeNegative", {}, "plan", with( plan_arguments, { "--time", "-1" } ), { "--time" } },
	    { "OptionOutInMissingFolder", {}, "check", { "--group", "arm", "--states", "states.csv", "--out", "none/out.csv" },
	        { "none/out.csv" } },
	    { "OptionOutIsAFolder", {}, "check", { "--group", "arm", "--states", "states.csv", "--out", "." },
	        { "cannot be written" } },
	    { "OptionPackagePathMissing", {}, "check", with( check_arguments, { "--package-path", "nowhere" } ),
	        { "--package-path nowhere", "no such folder" } },
	    { "OptionStatesRequired", {}, "check", { "--group", "arm" }, { "--states" } },
	};
}

class CliBadInput : public Cli, public testing::WithParamInterface<Case>
{
};

std::string caseName( const testing::TestParamInfo<Case>& info )
{
	return info.param.name;
}

} // namespace

TEST_P( CliBadInput, IsNamedAndLeavesNothing )
{
	const Case& bad = GetParam();
	for ( const Edit& change : bad.edits )
	{
		if ( change.from == "delete" )
		{
			ASSERT_EQ( std::remove( path( change.file ).c_str() ), 0 );
		}
		else if ( change.from.empty() )
		{
			write( change.file, change.to );
		}
		else
		{
			edit( change.file, change.from, change.to );
		}
	}
	const std::vector<std::string> before = files();
	const Outcome result = runModel( bad.subcommand, bad.arguments );
	EXPECT_EQ( result.status, 2 ) << result.out << result.err;
	EXPECT_EQ( result.out, "" );
	// exactly one line of error, the last one
	const std::size_t error = result.err.find( "leeway: error: " );
	ASSERT_NE( error, std::string::npos ) << result.err;
	EXPECT_EQ( std::count( result.err.begin() + static_cast<std::ptrdiff_t>( error ), result.err.end(), '\n' ), 1 )
	    << result.err;
	const std::string message = result.err.substr( error );
	EXPECT_FALSE( contains( message, "internal" ) ) << message;
	for ( const std::string& word : bad.words )
	{
		EXPECT_TRUE( contains( message, word ) ) << "lacks '" << word << "': " << message;
	}
	EXPECT_EQ( files(), before );
}

INSTANTIATE_TEST_SUITE_P( Model, CliBadInput, testing::ValuesIn( modelCases() ), caseName );
INSTANTIATE_TEST_SUITE_P( Tables, CliBadInput, testing::ValuesIn( tableCases() ), caseName );
INSTANTIATE_TEST_SUITE_P( Request, CliBadInput, testing::ValuesIn( requestCases() ), caseName );
INSTANTIATE_TEST_SUITE_P( Options, CliBadInput, testing::ValuesIn( optionCases() ), caseName );

TEST_F( Cli, AnEarlierResultSurvivesAnError )
{
	write( "out.csv", "an earlier result" );
	edit( "states.csv", "0.5,0.5", "0.5,nan" );
	EXPECT_EQ( runModel( "check", check_arguments ).status, 2 );
	EXPECT_EQ( readFile( path( "out.csv" ) ), "an earlier result" );
}

TEST_F( Cli, AQuaternionThatIsNotUnitIsRenormalisedWithANotice )
{
	const Outcome unit_run = runModel( "check", { "--group", "arm", "--states", "states.csv", "--what", "env" } );
	edit( "scene.yaml", unit, "orientation: [0, 0, 0, 3]" );
	const Outcome run_ = runModel( "check", { "--group", "arm", "--states", "states.csv", "--what", "env" } );
	EXPECT_EQ( run_.status, 0 ) << run_.err;
	EXPECT_TRUE( contains( run_.err, "notice" ) && contains( run_.err, "wall" ) ) << run_.err;
	EXPECT_FALSE( contains( unit_run.err, "wall" ) ) << unit_run.err;
	EXPECT_NEAR( parseTable( run_.out ).number( 0, "env_lower" ), 0.1, 1e-6 );
}

TEST_F( Cli, JointsThatTheRobotLacksOrFixesAreReadWithANotice )
{
	edit( "request.yaml", "[shoulder, elbow]", "[shoulder, elbow, tail, tool_joint]" );
	edit( "request.yaml", "[-1, 0]", "[-1, 0, 1, 0.5]" );
	const Outcome plan = runModel( "plan", { "--request", "request.yaml", "--out", "path.yaml" } );
	EXPECT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "tail" ) && contains( plan.err, "tool_joint" ) ) << plan.err;
}
