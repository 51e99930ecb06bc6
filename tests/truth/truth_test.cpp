// SPDX-License-Identifier: BSD-3-Clause
// Every row of every ground truth table: the certified intervals contain the distances that another engine found, whatever
// the range asked for, the way of the search and the instruction set.
//
// The tables are exact distances between triangle meshes, printed to 1e-9 m; joint values are printed to 1e-9 too, which
// moves a point 3 m away by up to 2e-8 m or so. Hence 1e-6 m. Cylinders are prisms of 512 sides there: up to 1.9e-5 of
// the radius inside of the true surface, hence 2.5e-6 m where one is nearest.
#include "groundtruth.hpp"

#include "leeway/io/model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <memory>

namespace
{

constexpr double TOLERANCE = 1e-6, CYLINDER_TOLERANCE = 2.5e-6;
/// Exact intervals have the width of the rounding of one double-precision distance: nanometres would be a lost digit.
constexpr double EXACT_WIDTH = 1e-9;
constexpr std::size_t TABLES = 16, ROWS = 700;

const std::vector<std::filesystem::path>& tableFiles()
{
	static const std::vector<std::filesystem::path> files = groundtruth::findTables( LEEWAY_DATA_DIR );
	return files;
}

/// Robot, scene and checkers of a table, with states in the checkers' order.
struct Subject
{
	groundtruth::Table table;
	leeway::Robot robot;
	leeway::Scene scene;
	leeway::Checker group; ///< over the group's variables: d_env and d_self_moving
	leeway::Checker all;   ///< over all variables: d_self
	std::vector<std::vector<double>> group_states, all_states;
	std::vector<bool> cylinder; ///< per object

	bool isCylinder( uint32_t object ) const { return object < cylinder.size() && cylinder[object]; }
	double tolerance( const groundtruth::Row& row, uint32_t nearest ) const
	{
		bool near_cylinder =
		    isCylinder( nearest ) || isCylinder( lw_scene_find_object( scene.get(), row.env_object.c_str() ) );
		return near_cylinder ? CYLINDER_TOLERANCE : TOLERANCE;
	}
};

/// The tables' own terms: no allowed contacts with the scene; joints outside of the group as in the first row.
leeway::Checker makeChecker( const Subject& subject, const std::vector<uint32_t>* variables )
{
	lw_checker_def def = lw_checker_def_default();
	def.robot = subject.robot.get();
	def.scene = subject.scene.get();
	def.variables = variables != nullptr ? variables->data() : nullptr;
	def.variable_count = variables != nullptr ? static_cast<uint32_t>( variables->size() ) : 0;
	def.reference = subject.all_states[0].data();
	lw_checker* checker = nullptr;
	lw_diag diag;
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	return leeway::Checker::adopt( checker );
}

/// Robot states of a table's rows: joints without a column are 0, a virtual joint is at the origin.
std::vector<std::vector<double>> robotStates( const lw_robot* robot, const groundtruth::Table& table )
{
	std::vector<double> neutral( lw_robot_variable_count( robot ) );
	lw_robot_default_state( robot, neutral.data() );
	std::vector<uint32_t> variable;
	for ( const std::string& joint : table.joints )
	{
		variable.push_back( lw_robot_joint_variable( robot, lw_robot_find_joint( robot, joint.c_str() ) ) );
	}
	for ( uint32_t i = 0; i < neutral.size(); ++i )
	{
		bool has_column = std::find( variable.begin(), variable.end(), i ) != variable.end();
		bool is_scalar = lw_robot_joint_variable_count( robot, lw_robot_variable( robot, i ).joint ) == 1;
		EXPECT_TRUE( has_column || !is_scalar || neutral[i] == 0 ) << "variable " << i;
	}
	std::vector<std::vector<double>> states;
	for ( const groundtruth::Row& row : table.rows )
	{
		states.push_back( neutral );
		for ( std::size_t i = 0; i < variable.size(); ++i )
		{
			states.back().at( variable[i] ) = row.q[i];
		}
	}
	return states;
}

std::unique_ptr<Subject> makeSubject( const std::filesystem::path& file )
{
	auto subject = std::make_unique<Subject>();
	subject->table = groundtruth::readTable( file, LEEWAY_DATA_DIR );
	const groundtruth::Table& table = subject->table;
	leeway::io::RobotModel model = leeway::io::loadRobot( table.urdf, table.srdf );
	leeway::io::SceneModel scene = leeway::io::loadScene( table.scene );
	leeway::io::ProblemOptions options;
	options.group = table.group;
	options.scene = &scene;
	leeway::io::Problem problem = leeway::io::buildProblem( model, options );
	subject->robot = problem.robot;
	subject->scene = problem.scene;
	subject->all_states = robotStates( problem.robot.get(), table );
	for ( const std::vector<double>& full : subject->all_states )
	{
		std::vector<double> state, rest = full;
		for ( uint32_t variable : problem.variables )
		{
			state.push_back( full[variable] );
			rest[variable] = subject->all_states[0][variable];
		}
		// Other variables are the same in all rows: one checker serves them all
		EXPECT_EQ( rest, subject->all_states[0] ) << table.name;
		subject->group_states.push_back( state );
	}
	subject->group = makeChecker( *subject, &problem.variables );
	subject->all = makeChecker( *subject, nullptr );

	for ( uint32_t i = 0; i < lw_scene_object_count( subject->scene.get() ); ++i )
	{
		subject->cylinder.push_back( false );
	}
	for ( uint32_t i = 0; i < lw_scene_shape_count( subject->scene.get() ); ++i )
	{
		lw_scene_shape_def shape = lw_scene_shape( subject->scene.get(), i );
		if ( lw_shape_get_info( shape.shape ).type == LW_SHAPE_CYLINDER )
		{
			subject->cylinder[shape.object] = true;
		}
	}
	return subject;
}

/// Counts disagreements, and describes the first few.
class Findings
{
public:
	void report( const groundtruth::Table& table, std::size_t row, const std::string& text )
	{
		if ( ++m_count <= 5 )
		{
			ADD_FAILURE() << table.name << " row " << row << " (" << table.rows[row].kind << "): " << text;
		}
	}
	~Findings()
	{
		if ( m_count > 5 )
		{
			ADD_FAILURE() << "and " << m_count - 5 << " more";
		}
	}

private:
	std::size_t m_count = 0;
};

std::string describe( const lw_clearance& c, double truth )
{
	char text[200];
	std::snprintf(
	    text, sizeof text, "kind %d [%.12g, %.12g] against %.12g", static_cast<int>( c.kind ), c.lower, c.upper, truth );
	return text;
}

/// True if the answer keeps the promise of the range for a distance that is known to within `tolerance`.
bool agrees( const lw_clearance& c, const lw_range& range, double truth, double tolerance )
{
	// Within the tolerance of an end of the range either class is right
	bool may_violate = truth <= range.min_d + tolerance, must_violate = truth < range.min_d - tolerance || truth == 0;
	bool may_be_far = truth >= range.max_d - tolerance, must_be_far = truth > range.max_d + tolerance;
	switch ( c.kind )
	{
	case LW_CLEARANCE_VIOLATION:
		// The search stopped at a pair of points that need not be the nearest
		return may_violate && c.lower == 0 && c.upper <= range.min_d && c.upper >= truth - tolerance;
	case LW_CLEARANCE_FAR:
		return may_be_far && c.lower == range.max_d && std::isinf( c.upper );
	case LW_CLEARANCE_NEAR:
		return !must_violate && !must_be_far && c.lower > range.min_d && c.upper < range.max_d &&
		       c.lower <= truth + tolerance && c.upper >= truth - tolerance &&
		       c.upper - c.lower <= range.alpha * c.upper + EXACT_WIDTH &&
		       ( range.alpha > 0 || c.upper <= truth + tolerance );
	case LW_CLEARANCE_UNDECIDED:
		return !must_violate && !must_be_far && c.lower <= range.min_d && c.upper - c.lower <= EXACT_WIDTH &&
		       std::abs( c.upper - truth ) <= tolerance;
	case LW_CLEARANCE_UNKNOWN:
		break;
	}
	return false;
}

class Truth : public testing::TestWithParam<std::size_t>
{
protected:
	/// Subjects are kept: a program that runs all tests loads each robot and scene once per table.
	void SetUp() override
	{
		static std::map<std::size_t, std::unique_ptr<Subject>> subjects;
		std::unique_ptr<Subject>& subject = subjects[GetParam()];
		if ( !subject )
		{
			subject = makeSubject( tableFiles()[GetParam()] );
		}
		m_subject = subject.get();
		ASSERT_EQ( m_subject->table.rows.size(), ROWS );
	}

	/// Every `stride`-th row through the group's checker, environment and self.
	void sweep( const lw_range& range, const lw_query_def& def, std::size_t stride = 1 )
	{
		leeway::Query query = leeway::makeQuery( m_subject->group.get(), def );
		Findings findings;
		for ( std::size_t i = 0; i < ROWS; i += stride )
		{
			const groundtruth::Row& row = m_subject->table.rows[i];
			lw_state_result got;
			ASSERT_EQ( lw_checker_state( m_subject->group.get(), query.get(), m_subject->group_states[i].data(),
			               LW_CHECK_BOTH, &range, false, &got ),
			    LW_OK );
			if ( !agrees( got.environment, range, row.d_env, m_subject->tolerance( row, got.environment.b ) ) )
			{
				findings.report( m_subject->table, i, "environment " + describe( got.environment, row.d_env ) );
			}
			if ( !agrees( got.self, range, row.d_self_moving, TOLERANCE ) )
			{
				findings.report( m_subject->table, i, "self " + describe( got.self, row.d_self_moving ) );
			}
			bool violated = got.environment.kind == LW_CLEARANCE_VIOLATION || got.self.kind == LW_CLEARANCE_VIOLATION;
			if ( violated != ( got.verdict == LW_VERDICT_BLOCKED ) )
			{
				findings.report( m_subject->table, i, "verdict is not that of the intervals" );
			}
		}
	}

	Subject* m_subject = nullptr;
};

lw_range makeRange( double min_d, double max_d, double alpha )
{
	lw_range range = lw_range_exact();
	range.min_d = min_d;
	range.max_d = max_d;
	range.alpha = alpha;
	return range;
}

constexpr double INFINITE = std::numeric_limits<double>::infinity();

TEST( TruthData, AllTablesAreThere )
{
	const char* ci = std::getenv( "CI" );
	if ( tableFiles().empty() && ( ci == nullptr || std::string( ci ) != "true" ) )
	{
		GTEST_SKIP() << "no ground truth below " << LEEWAY_DATA_DIR << "; set LEEWAY_DATA_DIR when configuring";
	}
	EXPECT_EQ( tableFiles().size(), TABLES ) << "below " << LEEWAY_DATA_DIR;
}

// Exact range. Contact is exact: a colliding row has an upper bound of 0, not of a few ulps, and no free row has.
TEST_P( Truth, ExactDistancesAgree )
{
	leeway::Query query = leeway::makeQuery( m_subject->group.get() );
	Findings findings;
	double widest = 0, worst = 0;
	int free = 0, colliding = 0;
	for ( std::size_t i = 0; i < ROWS; ++i )
	{
		const groundtruth::Row& row = m_subject->table.rows[i];
		lw_state_result got;
		ASSERT_EQ( lw_checker_state( m_subject->group.get(), query.get(), m_subject->group_states[i].data(), LW_CHECK_BOTH,
		               nullptr, false, &got ),
		    LW_OK );
		const lw_clearance &env = got.environment, &self = got.self;
		double tolerance = m_subject->tolerance( row, env.b );
		if ( !agrees( env, lw_range_exact(), row.d_env, tolerance ) || ( env.upper == 0 ) != row.in_collision_env )
		{
			findings.report( m_subject->table, i, "environment " + describe( env, row.d_env ) );
		}
		if ( !agrees( self, lw_range_exact(), row.d_self_moving, TOLERANCE ) )
		{
			findings.report( m_subject->table, i, "self " + describe( self, row.d_self_moving ) );
		}
		widest = std::max( { widest, env.upper - env.lower, self.upper - self.lower } );
		worst = std::max( { worst, std::abs( env.upper - row.d_env ), std::abs( self.upper - row.d_self_moving ) } );
		++( got.verdict == LW_VERDICT_BLOCKED ? colliding : free );
	}
	std::printf(
	    "largest difference %.3g m, widest interval %.3g m, %d free, %d colliding\n", worst, widest, free, colliding );
	EXPECT_GE( free, 100 );
	EXPECT_GE( colliding, 100 );
}

// A checker over all variables checks every pair that some joint can move.
TEST_P( Truth, SelfDistancesOverAllJointsAgree )
{
	leeway::Query query = leeway::makeQuery( m_subject->all.get() );
	Findings findings;
	for ( std::size_t i = 0; i < ROWS; ++i )
	{
		const groundtruth::Row& row = m_subject->table.rows[i];
		lw_state_result got;
		ASSERT_EQ( lw_checker_state( m_subject->all.get(), query.get(), m_subject->all_states[i].data(), LW_CHECK_SELF,
		               nullptr, false, &got ),
		    LW_OK );
		if ( !agrees( got.self, lw_range_exact(), row.d_self, TOLERANCE ) ||
		     ( got.self.upper == 0 ) != row.in_collision_self )
		{
			findings.report( m_subject->table, i, "self " + describe( got.self, row.d_self ) );
		}
		if ( got.environment.kind != LW_CLEARANCE_UNKNOWN )
		{
			findings.report( m_subject->table, i, "environment was not asked for" );
		}
	}
}

TEST_P( Truth, RelativeToleranceIsKept )
{
	sweep( makeRange( 0, INFINITE, 0.3 ), lw_query_def_default() );
}

TEST_P( Truth, FarIffBeyondMaxDistance )
{
	sweep( makeRange( 0, 0.05, 0 ), lw_query_def_default() );
	sweep( makeRange( 0, 0.05, 0.3 ), lw_query_def_default(), 3 );
}

TEST_P( Truth, ViolationIffWithinMinDistance )
{
	sweep( makeRange( 0.01, INFINITE, 0 ), lw_query_def_default() );
	sweep( makeRange( 0.01, 0.05, 0.3 ), lw_query_def_default(), 3 );
}

// The fastest validity check: nothing but yes or no, stopping at the first contact.
TEST_P( Truth, StopAtFirstGivesTheSameVerdict )
{
	const lw_range range = lw_range_threshold( 0 );
	leeway::Query query = leeway::makeQuery( m_subject->group.get() );
	Findings findings;
	for ( std::size_t i = 0; i < ROWS; ++i )
	{
		const groundtruth::Row& row = m_subject->table.rows[i];
		lw_state_result got;
		ASSERT_EQ( lw_checker_state( m_subject->group.get(), query.get(), m_subject->group_states[i].data(), LW_CHECK_BOTH,
		               &range, true, &got ),
		    LW_OK );
		bool blocked = row.d_env == 0 || row.d_self_moving == 0;
		if ( got.verdict != ( blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) )
		{
			findings.report( m_subject->table, i, lw_verdict_name( got.verdict ) );
		}
	}
}

TEST_P( Truth, SearchSwitchesChangeNoAnswer )
{
	lw_query_def def = lw_query_def_default();
	def.transform_caching = !def.transform_caching;
	sweep( lw_range_exact(), def, 2 );
	def = lw_query_def_default();
	def.warm_start = !def.warm_start;
	sweep( lw_range_exact(), def, 2 );
	def = lw_query_def_default();
	def.planes = !def.planes;
	sweep( lw_range_exact(), def, 4 );
}

TEST_P( Truth, EverySimdLevelAgrees )
{
	for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available(); ++level )
	{
		lw_query_def def = lw_query_def_default();
		def.simd = static_cast<lw_simd>( level );
		sweep( lw_range_exact(), def, 5 );
	}
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST( Truth );
INSTANTIATE_TEST_SUITE_P( Data, Truth, testing::Range<std::size_t>( 0, tableFiles().size() ),
    []( const testing::TestParamInfo<std::size_t>& table )
    { return tableFiles()[table.param].stem().string().substr( std::string( "groundtruth_" ).size() ); } );

} // namespace
