// SPDX-License-Identifier: BSD-3-Clause
// The certificate as bytes: FORMAT.md has the grammar.
#include "leeway/certify/certificate.hpp"
#include "certify/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>

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
	void digest()
	{
		const std::array<std::uint8_t, 32> value = sha256( text );
		text.append( value.begin(), value.end() );
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
	out.text = "LWCERT1\n";
	out.real( model.min_d );
	out.byte( static_cast<std::uint8_t>( model.claims ) );
	out.count( model.sources.size() );
	for ( const Source& source : model.sources )
	{
		out.words( source.name );
		out.text.append( source.digest.begin(), source.digest.end() );
	}
	out.count( model.variables.size() );
	for ( const Variable& variable : model.variables )
	{
		out.words( variable.name );
		out.real( variable.lower );
		out.real( variable.upper );
		out.real( variable.tolerance );
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
	out.digest();
}

void addMotion( Bytes& out, const std::vector<Piece>& pieces, std::size_t variables, const std::string& file )
{
	out.count( pieces.size() );
	for ( std::size_t k = 0; k < pieces.size(); ++k )
	{
		const std::vector<double>& points = pieces[k].points;
		if ( k == 0 )
		{
			out.reals( std::vector<double>( points.begin(), points.begin() + std::ptrdiff_t( variables ) ) );
		}
		else if ( !std::equal( points.begin(), points.begin() + std::ptrdiff_t( variables ),
		              pieces[k - 1].points.end() - std::ptrdiff_t( variables ) ) )
		{
			throw io::Error( file, fmt::format( "piece {}", k + 1 ), "it does not begin where the piece before ends",
			    "certify each part of the motion by itself" );
		}
		out.byte( static_cast<std::uint8_t>( pieces[k].degree ) );
		out.reals( std::vector<double>( points.begin() + std::ptrdiff_t( variables ), points.end() ) );
	}
}

/// The engine and the certificate must mean the same robot: poses of some states of the motion.
void compareKinematics( const io::Problem& problem, const Motion& motion, const std::vector<Piece>& pieces )
{
	const lw_robot* robot = problem.robot.get();
	for ( const Piece& piece : { pieces.front(), pieces.back() } )
	{
		std::vector<double> full = problem.reference;
		const std::size_t variables = problem.variables.size();
		const std::unique_ptr<Window> window = motion.whole( { 1, [&]
		    {
			    std::vector<double> twice( piece.points.begin(), piece.points.begin() + std::ptrdiff_t( variables ) );
			    twice.insert( twice.end(), piece.points.begin(), piece.points.begin() + std::ptrdiff_t( variables ) );
			    return twice;
		    }() } );
		for ( std::size_t i = 0; i < variables; ++i )
		{
			full[problem.variables[i]] = piece.points[i];
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
		good = good && piece.degree >= 1 && piece.degree <= LW_CURVE_MOST_DEGREE &&
		       piece.points.size() == ( piece.degree + 1 ) * variables &&
		       std::all_of(
		           piece.points.begin(), piece.points.end(), []( double value ) { return std::fabs( value ) <= 1000; } );
	}
	if ( !good )
	{
		throw io::Error( file, "motion", "certificates hold 1 piece or more, of degree 1 to 7, with values of at most 1000",
		    "check the motion" );
	}
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

Certificate certify( const io::Problem& problem, const io::RobotModel& robot, const std::vector<Piece>& pieces,
    const Settings& settings, const std::string& file )
{
	const auto begin = std::chrono::steady_clock::now();
	const auto seconds = [&] { return std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count(); };
	requireUsable( problem, pieces, file );
	const Model model = modelOf( problem, robot, pieces, settings, file );
	const std::vector<Pair> pairs = pairsOf( model );
	const Motion motion( model, pieces );
	compareKinematics( problem, motion, pieces );
	std::vector<const lw_shape*> bodies, obstacles;
	for ( std::uint32_t i = 0; i < model.bodies.size(); ++i )
	{
		bodies.push_back( lw_robot_body( problem.robot.get(), i ).shape );
	}
	for ( std::uint32_t i = 0; i < model.obstacles.size(); ++i )
	{
		obstacles.push_back( lw_scene_shape( problem.scene.get(), i ).shape );
	}
	const Query query = makeQuery( problem.checker.get() );
	Search search( motion, query.get(), bodies, obstacles );
	Bytes out;
	addModel( out, model );
	addMotion( out, pieces, problem.variables.size(), file );
	Certificate certificate;
	const std::size_t model_size = out.text.size();
	for ( std::size_t k = 0; k < pieces.size(); ++k )
	{
		const std::unique_ptr<Window> window = motion.whole( pieces[k] );
		std::uint64_t by_spheres = 0;
		for ( const Pair& pair : pairs )
		{
			if ( k > 0 && !pair.moves )
			{
				continue; // proved on the first piece
			}
			certificate.pairs += k == 0 && pair.moves ? 1 : 0;
			std::string proof;
			try
			{
				search.prove( model, pair, *window, proof );
			}
			catch ( const Failure& failure )
			{
				const std::string& b = pair.object ? model.objects[model.obstacles[pair.b].owner]
				                                   : model.links[model.bodies[pair.b].owner].name;
				throw io::Error( file, fmt::format( "piece {}, t = {:.6g}", k + 1, failure.time ),
				    fmt::format( "{} - {} {}", model.links[model.bodies[pair.a].owner].name, b, failure.why ),
				    "plan with a larger --min-d than the certificate's, or allow the pair" );
			}
			if ( seconds() > settings.seconds )
			{
				throw io::Error( file, fmt::format( "piece {}", k + 1 ),
				    fmt::format( "the certificate is not complete after {} s", settings.seconds ),
				    "plan with a larger --min-d" );
			}
			if ( proof.size() == 1 )
			{
				++by_spheres;
				continue;
			}
			out.count( by_spheres );
			out.text += proof;
			by_spheres = 0;
		}
		out.count( by_spheres );
	}
	certificate.proof_size = out.text.size() - model_size;
	out.digest();
	certificate.bytes = std::move( out.text );
	certificate.windows = search.windows();
	certificate.seconds = seconds();
	return certificate;
}

std::string describe( const Certificate& certificate, const std::string& file )
{
	return fmt::format( "certificate {}: {} pairs proved in {} windows, {} bytes, of which {} are the proof", file,
	    certificate.pairs, certificate.windows, certificate.bytes.size(), certificate.proof_size );
}

} // namespace leeway::certify
