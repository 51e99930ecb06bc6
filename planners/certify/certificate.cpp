// SPDX-License-Identifier: BSD-3-Clause
// The certificate as bytes: FORMAT.md has the grammar.
#include "leeway/certify/certificate.hpp"
#include "certify/schedule.hpp"
#include "certify/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

namespace leeway::certify
{
namespace
{

class Bytes
{
public:
	void byte( std::uint8_t value ) { text.push_back( static_cast<char>( value ) ); }
	/// Seven bits a byte, the lowest first.
	void count( std::uint64_t value )
	{
		for ( ; value >= 128; value >>= 7 )
		{
			byte( static_cast<std::uint8_t>( value | 128 ) );
		}
		byte( static_cast<std::uint8_t>( value ) );
	}
	void words( const std::string& value )
	{
		count( value.size() );
		text += value;
	}
	void real( double value )
	{
		std::uint64_t bits;
		std::memcpy( &bits, &value, sizeof( bits ) );
		for ( int i = 0; i < 64; i += 8 )
		{
			byte( static_cast<std::uint8_t>( bits >> i ) );
		}
	}
	void shortReal( double value )
	{
		const auto rounded = static_cast<float>( value );
		std::uint32_t bits;
		std::memcpy( &bits, &rounded, sizeof( bits ) );
		for ( int i = 0; i < 32; i += 8 )
		{
			byte( static_cast<std::uint8_t>( bits >> i ) );
		}
	}
	template <typename Range> void reals( const Range& values )
	{
		for ( const double value : values )
		{
			real( value );
		}
	}
	std::string text;
};

void add( Bytes& out, const Link& link )
{
	out.words( link.name );
	out.words( link.joint );
	out.count( link.parent );
	out.reals( link.origin );
	out.byte( link.type );
	if ( link.type != Link::fixed )
	{
		out.reals( link.axis );
		out.count( link.variable == nothing ? 0 : link.variable + 1 );
		out.real( link.multiplier );
		out.real( link.offset );
	}
}

void add( Bytes& out, const Shape& shape )
{
	const bool is_short = std::all_of( shape.numbers.begin(), shape.numbers.end(),
	    []( double value ) { return std::fabs( value ) < 1e30 && double( float( value ) ) == value; } );
	out.words( shape.source );
	out.byte( static_cast<std::uint8_t>( shape.kind ) );
	out.byte( static_cast<std::uint8_t>( ( is_short ? 1 : 0 ) + ( shape.solid ? 2 : 0 ) ) );
	out.real( shape.radius );
	out.real( shape.height );
	out.count( shape.numbers.size() );
	for ( const double value : shape.numbers )
	{
		is_short ? out.shortReal( value ) : out.real( value );
	}
	out.count( shape.corners.size() );
	for ( const std::uint32_t corner : shape.corners )
	{
		out.count( corner );
	}
}

void add( Bytes& out, const std::vector<Placed>& placed )
{
	out.count( placed.size() );
	for ( const Placed& one : placed )
	{
		out.count( one.owner );
		out.count( one.shape );
		out.reals( one.pose );
	}
}

void addModel( Bytes& out, const Model& model )
{
	out.text = "LWCERT2\n";
	out.byte( static_cast<std::uint8_t>( model.claims ) );
	out.count( model.variables.size() );
	for ( const Variable& variable : model.variables )
	{
		out.words( variable.name );
		out.real( variable.lower );
		out.real( variable.upper );
	}
	out.count( model.links.size() );
	for ( const Link& link : model.links )
	{
		add( out, link );
	}
	out.count( model.shapes.size() );
	for ( const Shape& shape : model.shapes )
	{
		add( out, shape );
	}
	add( out, model.bodies );
	out.count( model.objects.size() );
	for ( const std::string& object : model.objects )
	{
		out.words( object );
	}
	add( out, model.obstacles );
	out.count( model.allowed.size() );
	for ( const Allowed& pair : model.allowed )
	{
		out.byte( pair.object ? 1 : 0 );
		out.count( pair.a );
		out.count( pair.b );
		out.words( pair.reason );
	}
	out.count( model.margins.size() );
	for ( const Margin& margin : model.margins )
	{
		out.byte( margin.object ? 1 : 0 );
		out.count( margin.a );
		out.count( margin.b );
		out.real( margin.value );
	}
}

void addSources( Bytes& out, const std::vector<std::string>& sources )
{
	out.count( sources.size() );
	for ( const std::string& name : sources )
	{
		std::ifstream in( name, std::ios::binary );
		std::ostringstream text;
		text << in.rdbuf();
		if ( !in )
		{
			throw io::Error( name, "SHA-256", "the file cannot be read again", "leave it where it is while leeway runs" );
		}
		Digest digest;
		digest.add( text.str().data(), text.str().size() );
		out.words( name.substr( name.rfind( '/' ) + 1 ) );
		const std::array<std::uint8_t, 32> value = digest.value();
		out.text.append( value.begin(), value.end() );
	}
}

void addMotion( Bytes& out, const std::vector<Piece>& pieces, std::size_t variables, double begin )
{
	out.real( begin );
	out.count( pieces.size() );
	out.reals( std::vector<double>( pieces[0].points.begin(), pieces[0].points.begin() + std::ptrdiff_t( variables ) ) );
	for ( const Piece& piece : pieces )
	{
		out.byte( static_cast<std::uint8_t>( piece.degree ) );
		out.real( piece.seconds );
		out.reals( std::vector<double>( piece.points.begin() + std::ptrdiff_t( variables ), piece.points.end() ) );
	}
}

/// The engine and the certificate must mean the same robot: poses at both ends of the motion.
void compareKinematics( const io::Problem& problem, const Motion& motion, const std::vector<Piece>& pieces )
{
	const lw_robot* robot = problem.robot.get();
	const std::size_t variables = problem.variables.size();
	const Tubes none = { std::vector<double>( variables, 0 ), {} };
	const std::vector<double>&first = pieces.front().points, &last = pieces.back().points;
	for ( const double* values : { first.data(), last.data() + last.size() - variables } )
	{
		std::vector<double> full = problem.reference, twice( values, values + variables );
		twice.insert( twice.end(), values, values + variables );
		const std::unique_ptr<Window> window = motion.whole( { 1, twice }, none );
		for ( std::size_t i = 0; i < variables; ++i )
		{
			full[problem.variables[i]] = values[i];
		}
		std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
		require( lw_robot_fk( robot, full.data(), poses.data() ), "lw_robot_fk" );
		const Model& model = motion.model();
		for ( std::uint32_t i = 0; i < model.bodies.size(); ++i )
		{
			const Pose& ours = window->links[model.bodies[i].owner];
			const lw_transform& core = poses[lw_robot_body( robot, i ).link];
			double difference = 0;
			for ( int k = 0; k < 3; ++k )
			{
				difference = std::max( difference, std::fabs( ours.shift[k] - core.t[k] ) );
				for ( int l = 0; l < 3; ++l )
				{
					difference = std::max( difference, std::fabs( ours.columns[l][k] - core.r[k][l] ) );
				}
			}
			if ( !( difference <= 10 * motion.rounding() + 1e-12 ) )
			{
				throw CoreError( LW_ERROR_INVALID_ARGUMENT,
				    fmt::format( "link {}: the certificate's kinematics differ from the engine's by {:.2g}",
				        model.links[model.bodies[i].owner].name, difference ) );
			}
		}
	}
}

void requireUsable( const io::Problem& problem, const std::vector<Piece>& pieces, const std::string& file )
{
	const std::size_t variables = problem.variables.size();
	bool good = !pieces.empty() && variables > 0;
	for ( const Piece& piece : pieces )
	{
		good = good && piece.degree >= 1 && piece.degree <= LW_CURVE_MOST_DEGREE && piece.seconds >= 0 &&
		       piece.points.size() == ( piece.degree + 1 ) * variables &&
		       std::all_of(
		           piece.points.begin(), piece.points.end(), []( double value ) { return std::fabs( value ) <= 1000; } );
	}
	if ( !good )
	{
		throw io::Error( file, "motion", "certificates hold 1 piece or more, of degree 1 to 7, with values of at most 1000",
		    "check the motion" );
	}
	for ( std::size_t k = 1; k < pieces.size(); ++k )
	{
		const std::vector<double>&before = pieces[k - 1].points, &points = pieces[k].points;
		if ( !std::equal(
		         points.begin(), points.begin() + std::ptrdiff_t( variables ), before.end() - std::ptrdiff_t( variables ) ) )
		{
			throw io::Error( file, fmt::format( "piece {}", k + 1 ), "it does not begin where the piece before ends",
			    "certify each part of the motion by itself" );
		}
	}
}

/// Places of the quaternions in a state of the group.
std::vector<std::pair<std::size_t, std::string>> quaternionsOf( const io::Problem& problem )
{
	const lw_robot* robot = problem.robot.get();
	std::vector<std::pair<std::size_t, std::string>> out;
	for ( std::uint32_t joint = 0; joint < lw_robot_joint_count( robot ); ++joint )
	{
		for ( std::size_t i = 0; i < problem.variables.size() && lw_robot_joint_type( robot, joint ) == LW_JOINT_FLOATING;
		      ++i )
		{
			const std::uint32_t first = lw_robot_joint_variable( robot, joint ) + 3;
			if ( problem.variables[i] >= first && problem.variables[i] < first + 4 )
			{
				out.emplace_back( i, lw_robot_joint_name( robot, joint ) );
			}
		}
	}
	return out;
}

} // namespace

std::vector<Piece> piecesOf( const io::Problem& problem, const std::vector<std::vector<double>>& points )
{
	constexpr double turn = 6.28318530717958647692;
	std::vector<Piece> pieces;
	std::vector<double> at = points.front();
	for ( std::size_t k = 0; k == 0 || k + 1 < points.size(); ++k )
	{
		const std::vector<double>& to = points[std::min( k + 1, points.size() - 1 )];
		std::vector<double> next = to;
		for ( std::size_t i = 0; i < to.size(); ++i )
		{
			if ( lw_robot_variable( problem.robot.get(), problem.variables[i] ).wraps )
			{
				next[i] += turn * std::round( ( at[i] - to[i] ) / turn );
			}
		}
		Piece piece{ 1, at };
		piece.points.insert( piece.points.end(), next.begin(), next.end() );
		pieces.push_back( std::move( piece ) );
		at = next;
	}
	return pieces;
}

/// The common part of the certificates of one robot in one scene.
struct Common
{
	Common( const io::Problem& problem, const io::RobotModel& robot, const double* state, lw_check_flags flags,
	    const std::string& file )
	    : model( modelOf( problem, robot, state, flags, file ) ), pairs( pairsOf( model ) ), motion( model )
	{
		addModel( bytes, model );
		digest.add( bytes.text.data(), bytes.text.size() );
		const std::array<std::uint8_t, 32> value = digest.value();
		digest.add( reinterpret_cast<const char*>( value.data() ), value.size() );
		bytes.text.append( value.begin(), value.end() );
		for ( std::uint32_t i = 0; i < model.bodies.size(); ++i )
		{
			bodies.push_back( lw_robot_body( problem.robot.get(), i ).shape );
		}
		for ( std::uint32_t i = 0; i < model.obstacles.size(); ++i )
		{
			obstacles.push_back( lw_scene_shape( problem.scene.get(), i ).shape );
		}
	}
	Common( const Common& ) = delete;
	Common& operator=( const Common& ) = delete;

	const Model model;
	std::vector<Pair> pairs;
	Motion motion;
	Bytes bytes;   ///< of the file, to the first digest
	Digest digest; ///< of these
	std::vector<const lw_shape*> bodies, obstacles;
};

struct Writer::State
{
	State( const io::Problem& of_problem, const io::RobotModel& of_robot )
	    : problem( of_problem ), robot( of_robot ), query( makeQuery( of_problem.checker.get() ) ),
	      quaternions( quaternionsOf( of_problem ) )
	{
	}
	Common& commonOf( const std::vector<Piece>& pieces, lw_check_flags flags, const std::string& file );

	const io::Problem& problem;
	const io::RobotModel& robot;
	Query query;
	const std::vector<std::pair<std::size_t, std::string>> quaternions;
	std::vector<double> resting; ///< values of quaternions in `common`
	std::optional<Common> common;
};

Common& Writer::State::commonOf( const std::vector<Piece>& pieces, lw_check_flags flags, const std::string& file )
{
	std::vector<double> values;
	for ( const auto& [place, name] : quaternions )
	{
		values.push_back( pieces.front().points[place] );
		for ( const Piece& piece : pieces )
		{
			for ( std::size_t i = place; i < piece.points.size(); i += problem.variables.size() )
			{
				if ( piece.points[i] != values.back() )
				{
					throw io::Error( file, "joint " + name, "certificates cannot hold a floating joint that turns",
					    "plan for a group without this joint" );
				}
			}
		}
	}
	if ( !common || common->model.claims != flags || values != resting )
	{
		common.emplace( problem, robot, pieces.front().points.data(), flags, file );
		resting = values;
	}
	return *common;
}

/// The proof of all pieces; those that lags or spreads leave undecided are halved.
class Proof
{
public:
	Proof( Common& common, lw_query* query, const std::vector<Piece>& pieces, const Settings& settings,
	    const std::vector<Deviation>& deviations, const std::string& file )
	    : m_common( common ), m_search( common.motion, query, common.bodies, common.obstacles ), m_settings( settings ),
	      m_deviations( deviations ), m_file( file ), m_pieces( pieces )
	{
		m_may_halve = std::any_of(
		    deviations.begin(), deviations.end(), []( const Deviation& one ) { return one.lag > 0 || one.spread > 0; } );
		m_halved.assign( pieces.size(), 0 );
		m_hints.assign( common.pairs.size(), { 0, 0, 0 } );
	}
	void run();
	const std::vector<Piece>& pieces() const { return m_pieces; }
	const std::string& text() const { return m_out.text; }
	const Search& search() const { return m_search; }

private:
	void piece( std::size_t k );

	static constexpr unsigned most_halvings = 12;
	const std::chrono::steady_clock::time_point m_begin = std::chrono::steady_clock::now();
	Common& m_common;
	Search m_search;
	const Settings& m_settings;
	const std::vector<Deviation>& m_deviations;
	const std::string& m_file;
	std::vector<Piece> m_pieces;
	std::vector<unsigned> m_halved; ///< how often, each piece
	std::vector<Vec> m_hints;       ///< of pairs
	bool m_may_halve;
	Bytes m_out;
};

/// @throws Failure, which names the pair
void Proof::piece( std::size_t k )
{
	const Model& model = m_common.model;
	const Tubes tubes = tubesOf( m_pieces, k, m_settings.begin, m_deviations );
	const std::unique_ptr<Window> window = m_common.motion.whole( m_pieces[k], tubes );
	std::uint64_t by_spheres = 0;
	std::string proof;
	for ( const Pair& pair : m_common.pairs )
	{
		if ( k > 0 && !pair.moves )
		{
			continue; // proved on the first piece
		}
		proof.clear();
		try
		{
			m_search.prove( pair, m_settings.min_d, *window, m_hints[std::size_t( &pair - m_common.pairs.data() )], proof );
		}
		catch ( Failure& failure )
		{
			const std::string& b =
			    pair.object ? model.objects[model.obstacles[pair.b].owner] : model.links[model.bodies[pair.b].owner].name;
			failure.why = fmt::format( "{} - {} {}", model.links[model.bodies[pair.a].owner].name, b, failure.why );
			throw;
		}
		if ( proof.size() > 1 &&
		     std::chrono::duration<double>( std::chrono::steady_clock::now() - m_begin ).count() > m_settings.seconds )
		{
			throw io::Error( m_file, fmt::format( "piece {}", k + 1 ),
			    fmt::format( "the certificate is not complete after {} s", m_settings.seconds ),
			    "plan with a larger --min-d" );
		}
		if ( proof.size() == 1 )
		{
			++by_spheres;
			continue;
		}
		m_out.count( by_spheres );
		m_out.text += proof;
		by_spheres = 0;
	}
	m_out.count( by_spheres );
}

void Proof::run()
{
	for ( std::size_t k = 0; k < m_pieces.size(); )
	{
		const std::size_t size = m_out.text.size(), spheres = m_search.spheres, directions = m_search.directions;
		try
		{
			piece( k );
			++k;
		}
		catch ( const Failure& failure )
		{
			if ( !m_may_halve || m_halved[k] >= most_halvings )
			{
				throw io::Error( m_file, fmt::format( "piece {}, t = {:.6g}", k + 1, failure.time ), failure.why,
				    "plan with a larger --min-d than the certificate's, or allow the pair" );
			}
			// The tubes of pieces before may shrink: their proofs hold all the more
			m_out.text.resize( size );
			m_search.spheres = spheres;
			m_search.directions = directions;
			halvePiece( m_pieces, k, m_common.model.variables.size() );
			m_halved.insert( m_halved.begin() + std::ptrdiff_t( k ), ++m_halved[k] );
		}
	}
}

Writer::Writer( const io::Problem& problem, const io::RobotModel& robot )
    : m_state( std::make_unique<State>( problem, robot ) )
{
}

Writer::~Writer() = default;

Certificate Writer::write( const std::vector<Piece>& pieces, const Settings& settings, const std::string& file )
{
	const auto begin = std::chrono::steady_clock::now();
	const io::Problem& problem = m_state->problem;
	requireUsable( problem, pieces, file );
	Common& common = m_state->commonOf( pieces, settings.flags, file );
	common.motion.begin( pieces );
	compareKinematics( problem, common.motion, pieces );
	const std::vector<Deviation> deviations = deviationsOf( common.model, settings );
	setLate( common.model, pieces, deviations, common.pairs );
	Proof proof( common, m_state->query.get(), pieces, settings, deviations, file );
	proof.run();
	Bytes out;
	out.text = common.bytes.text;
	const std::size_t model_size = out.text.size();
	out.real( settings.min_d );
	addSources( out, settings.sources );
	for ( const Deviation& one : deviations )
	{
		out.count( one.track );
		out.reals( std::array<double, 4>{ one.tolerance, one.lag, one.spread, one.since } );
	}
	addMotion( out, proof.pieces(), problem.variables.size(), settings.begin );
	out.text += proof.text();
	Digest digest = common.digest;
	digest.add( out.text.data() + model_size, out.text.size() - model_size );
	const std::array<std::uint8_t, 32> value = digest.value();
	out.text.append( value.begin(), value.end() );
	Certificate certificate;
	certificate.pairs = static_cast<std::size_t>(
	    std::count_if( common.pairs.begin(), common.pairs.end(), []( const Pair& pair ) { return pair.moves; } ) );
	certificate.proof_size = proof.text().size();
	certificate.bytes = std::move( out.text );
	certificate.spheres = proof.search().spheres;
	certificate.directions = proof.search().directions;
	certificate.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count();
	return certificate;
}

Certificate certify( const io::Problem& problem, const io::RobotModel& robot, const std::vector<Piece>& pieces,
    const Settings& settings, const std::string& file )
{
	return Writer( problem, robot ).write( pieces, settings, file );
}

std::string describe( const Certificate& certificate, const std::string& file )
{
	return fmt::format( "certificate {}: {} pairs proved in {} windows, {} bytes, of which {} are the proof", file,
	    certificate.pairs, certificate.windows(), certificate.bytes.size(), certificate.proof_size );
}

} // namespace leeway::certify
