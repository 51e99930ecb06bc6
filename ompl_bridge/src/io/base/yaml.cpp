// SPDX-License-Identifier: BSD-3-Clause
// YAML of MoveIt messages: nodes that know where they are, strict numbers, both spellings of vectors and poses.
#include "base/yaml.hpp"

#include "leeway/io/keys.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <sstream>
#include <yaml-cpp/eventhandler.h>

namespace leeway::io::detail
{

namespace
{

/// Refuses keys that are there twice, merge keys, and documents that contain themselves or would be far larger than their text.
class DocumentCheck
{
public:
	/// Each node takes a character, or follows from one, unless an alias repeats it.
	DocumentCheck( const std::string& file, std::size_t text_size, std::size_t first_line )
	    : m_file( file ), m_spelled_out( 2 * text_size + 2 ), m_first_line( first_line )
	{
	}

	void visit( const YAML::Node& node, unsigned depth = 0 )
	{
		if ( depth > currentLimits().nesting )
		{
			throw Error( m_file, fmt::format( "line {}", lineOf( node ) ),
			    fmt::format( "is nested too deeply (the limit nesting is {}), or contains itself", currentLimits().nesting ),
			    "give a MoveIt message in YAML" );
		}
		if ( ++m_nodes > m_spelled_out )
		{
			checkLimit( &Limits::alias_nodes, m_nodes - m_spelled_out, "nodes by its aliases", m_file, "" );
		}
		if ( node.IsSequence() )
		{
			for ( const YAML::Node& entry : node )
			{
				visit( entry, depth + 1 );
			}
		}
		if ( node.IsMap() )
		{
			visitMap( node, depth );
		}
	}

private:
	void visitMap( const YAML::Node& node, unsigned depth )
	{
		std::map<std::string, std::size_t> keys; // to their lines
		for ( const auto& entry : node )
		{
			const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
			if ( key == "<<" )
			{
				throw Error( m_file, fmt::format( "<< (line {})", lineOf( entry.first ) ),
				    "merge keys are not read: their values would be lost", "write the values out" );
			}
			const auto [first, fresh] = keys.emplace( key, lineOf( entry.first ) );
			if ( entry.first.IsScalar() && !fresh )
			{
				throw Error( m_file, fmt::format( "{} (line {})", key, lineOf( entry.first ) ),
				    fmt::format( "the key is there twice, in line {} too", first->second ), "remove one of them" );
			}
			visit( entry.second, depth + 1 );
		}
	}

	std::size_t lineOf( const YAML::Node& node ) const
	{
		return m_first_line + static_cast<std::size_t>( node.Mark().line + 1 );
	}

	const std::string& m_file;
	std::uint64_t m_spelled_out, m_nodes = 0;
	std::size_t m_first_line;
};

} // namespace

namespace
{

/// Listens to a parser and keeps nothing.
class Nobody : public YAML::EventHandler
{
public:
	void OnDocumentStart( const YAML::Mark& ) override {}
	void OnDocumentEnd() override {}
	void OnNull( const YAML::Mark&, YAML::anchor_t ) override {}
	void OnAlias( const YAML::Mark&, YAML::anchor_t ) override {}
	void OnScalar( const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string& ) override {}
	void OnSequenceStart( const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value ) override {}
	void OnSequenceEnd() override {}
	void OnMapStart( const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value ) override {}
	void OnMapEnd() override {}
};

/// True if the first line that is not empty begins with a name, and every later line with a name, an entry, a blank or a
/// comment. The text is then one block map without a second document, and need not be parsed twice. (A document that is no
/// map is refused elsewhere.)
bool isOneMap( const std::string& text )
{
	bool begun = false;
	for ( std::size_t line = 0; line < text.size(); )
	{
		const std::size_t end = std::min( text.find( '\n', line ), text.size() );
		const std::size_t first = std::min( text.find_first_not_of( ' ', line ), end );
		const char c = text[line];
		const bool name = ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' ) || c == '_';
		const bool entry = c == '-' && line + 1 < end && text[line + 1] == ' ';
		const bool empty = first == end || text[first] == '#';
		if ( !empty && !name && ( !begun || ( !entry && c != ' ' ) ) )
		{
			return false;
		}
		begun = begun || !empty;
		line = end + 1;
	}
	return begun;
}

} // namespace

YamlNode YamlNode::load( const std::string& file, std::vector<Notice>& notices )
{
	return parse( file, readWholeFile( file ), notices );
}

YamlNode YamlNode::parse( const std::string& file, std::string text, std::vector<Notice>& notices )
{
	YamlNode root;
	root.m_file = std::make_shared<const std::string>( file );
	root.m_notices = &notices;
	try
	{
		if ( holdsSeveralDocuments( text ) )
		{
			throw Error( file, "", "holds several YAML documents", "keep one" );
		}
		root.m_node = YAML::Load( text );
		requireSoundDocument( file, root.m_node, text.size() );
	}
	catch ( const YAML::Exception& e )
	{
		throw Error( file, fmt::format( "line {}", e.mark.line + 1 ), fmt::format( "not well-formed YAML: {}", e.msg ),
		    "correct the file at that line" );
	}
	if ( !root.isMap() )
	{
		throw Error( file, "", "is not a map of keys and values", "give a MoveIt message in YAML" );
	}
	return root;
}

YamlNode YamlNode::child( const YAML::Node& node, const std::string& path ) const
{
	YamlNode result;
	result.m_node.reset( node );
	result.m_path = path;
	result.m_file = m_file;
	result.m_notices = m_notices;
	return result;
}

std::string YamlNode::place() const
{
	YAML::Mark mark = m_node.IsDefined() ? m_node.Mark() : YAML::Mark::null_mark();
	return mark.is_null() ? m_path : fmt::format( "{} (line {})", m_path, mark.line + 1 );
}

void YamlNode::fail( const std::string& problem, const std::string& remedy ) const
{
	throw Error( *m_file, place(), problem, remedy );
}

void YamlNode::notice( const std::string& text ) const
{
	m_notices->push_back( { *m_file, place(), text } );
}

std::size_t YamlNode::size() const
{
	if ( !defined() )
	{
		return 0;
	}
	if ( !isList() )
	{
		fail( "is not a list", "write a list" );
	}
	return m_node.size();
}

YamlNode YamlNode::operator[]( const char* key ) const
{
	std::string path = m_path.empty() ? key : m_path + "." + key;
	if ( !defined() )
	{
		return child( YAML::Node( YAML::NodeType::Undefined ), path );
	}
	if ( !isMap() )
	{
		fail( fmt::format( "is not a map with a key {}", key ), "write keys and values" );
	}
	const YAML::Node& node = m_node;
	YAML::Node value = node[key];
	return child( value.IsDefined() ? value : YAML::Node( YAML::NodeType::Undefined ), path );
}

YamlNode YamlNode::operator[]( std::size_t index ) const
{
	const YAML::Node& node = m_node;
	return child( node[index], fmt::format( "{}[{}]", m_path, index ) );
}

YamlNode YamlNode::firstOf( std::initializer_list<const char*> keys ) const
{
	for ( const char* key : keys )
	{
		YamlNode value = ( *this )[key];
		if ( value.defined() )
		{
			return value;
		}
	}
	return ( *this )[*keys.begin()];
}

YamlNode YamlNode::named( const std::string& name ) const
{
	return child( m_node, m_path + " " + name );
}

void YamlNode::refuseUnknownKeys( const std::vector<std::string>& known ) const
{
	for ( const std::string& key : keys() )
	{
		if ( std::find( known.begin(), known.end(), key ) == known.end() )
		{
			refuseMisspelt( key, known );
			( *this )[key.c_str()].fail( "this key is not known", fmt::format( "use {}", joinNames( known ) ) );
		}
	}
}

void YamlNode::noticeUnused( const std::vector<std::string>& keys, const std::string& why ) const
{
	std::vector<std::string> unused;
	for ( const std::string& key : keys )
	{
		const YamlNode value = ( *this )[key.c_str()];
		if ( value.defined() && !saysNothing( value.m_node ) )
		{
			unused.push_back( key );
		}
	}
	if ( !unused.empty() )
	{
		notice( fmt::format( "not used: {}: {}", joinNames( unused ), why ) );
	}
}

void YamlNode::refuseUsed(
    const std::vector<std::string>& keys, const std::string& problem, const std::string& remedy ) const
{
	for ( const std::string& key : keys )
	{
		const YamlNode value = ( *this )[key.c_str()];
		if ( value.defined() && !saysNothing( value.m_node ) )
		{
			value.fail( problem, remedy );
		}
	}
}

void YamlNode::refuseMisspelt( const std::string& key, const std::vector<std::string>& known ) const
{
	const std::string meant = meantKey( key, known );
	if ( !meant.empty() )
	{
		( *this )[key.c_str()].fail(
		    fmt::format( "this key is not known: is {} meant?", meant ), fmt::format( "write {}, or remove it", meant ) );
	}
}

void YamlNode::noticeUnknownKeys( const std::vector<std::string>& known ) const
{
	for ( const std::string& key : keys() )
	{
		if ( std::find( known.begin(), known.end(), key ) == known.end() )
		{
			refuseMisspelt( key, known );
			const YamlNode value = ( *this )[key.c_str()];
			if ( key.compare( 0, 7, "leeway_" ) == 0 )
			{
				value.fail( "there is no such extension here", "see ompl_bridge/docs/scenes.md for those there are" );
			}
			value.notice( "this key is not known: ignored" );
		}
	}
}

double YamlNode::number() const
{
	if ( !isScalar() )
	{
		fail( defined() ? "is not a number" : "is missing", "write a finite number" );
	}
	std::string text = lower( m_node.Scalar() );
	std::optional<double> value = parseNumber( text );
	bool yaml_special = text == ".nan" || text == ".inf" || text == "-.inf" || text == "+.inf";
	if ( yaml_special || ( value && !std::isfinite( *value ) ) )
	{
		fail( fmt::format( "{} is not finite", m_node.Scalar() ), "write a finite number" );
	}
	if ( !value )
	{
		fail( fmt::format( "\"{}\" is not a number", m_node.Scalar() ), "write a finite number" );
	}
	return *value;
}

std::string YamlNode::text() const
{
	if ( !isScalar() )
	{
		fail( defined() ? "is not a text" : "is missing", "write a name" );
	}
	if ( !isUtf8( m_node.Scalar() ) )
	{
		fail( fmt::format( "\"{}\" is not UTF-8", m_node.Scalar() ), "save the file as UTF-8" );
	}
	return m_node.Scalar();
}

std::string YamlNode::textOr( const char* fallback ) const
{
	return defined() ? text() : fallback;
}

bool YamlNode::boolean() const
{
	std::string value = isScalar() ? lower( m_node.Scalar() ) : "";
	if ( value == "true" || value == "1" || value == "yes" )
	{
		return true;
	}
	if ( value != "false" && value != "0" && value != "no" )
	{
		fail( "is neither true nor false", "write true or false" );
	}
	return false;
}

std::vector<double> YamlNode::numberList() const
{
	std::vector<double> values;
	for ( std::size_t i = 0; i < size(); ++i )
	{
		values.push_back( ( *this )[i].number() );
	}
	return values;
}

std::vector<std::string> YamlNode::textList() const
{
	std::vector<std::string> values;
	for ( std::size_t i = 0; i < size(); ++i )
	{
		values.push_back( ( *this )[i].text() );
	}
	return values;
}

std::string YamlNode::bytes() const
{
	if ( isScalar() && m_node.Tag() == "tag:yaml.org,2002:binary" )
	{
		// yaml-cpp 0.7 looks characters above 127 up before the beginning of its table
		const std::string& text = m_node.Scalar();
		const bool ascii = std::all_of( text.begin(), text.end(), []( unsigned char c ) { return c < 128; } );
		const std::vector<unsigned char> bytes = ascii ? YAML::DecodeBase64( text ) : std::vector<unsigned char>();
		if ( bytes.empty() && !text.empty() )
		{
			fail( "is not base64", "write !!binary and base64, or a list of numbers" );
		}
		return std::string( bytes.begin(), bytes.end() );
	}
	std::string bytes;
	bytes.reserve( size() );
	// Maps have millions of them: no path for each but the bad one
	std::size_t index = 0;
	for ( auto entry = m_node.begin(); defined() && entry != m_node.end(); ++entry, ++index )
	{
		const double value = entry->IsScalar() ? parseNumber( entry->Scalar() ).value_or( NAN ) : NAN;
		if ( !( value >= -128 && value <= 255 && value == std::floor( value ) ) )
		{
			( *this )[index].fail( "is no byte", "write whole numbers from -128 to 255" );
		}
		bytes.push_back( static_cast<char>( static_cast<int>( value ) ) );
	}
	return bytes;
}

std::vector<std::string> YamlNode::keys() const
{
	std::vector<std::string> names;
	for ( auto entry = m_node.begin(); isMap() && entry != m_node.end(); ++entry )
	{
		if ( !entry->first.IsScalar() )
		{
			fail( "has a key that is no name", "write names and values" );
		}
		names.push_back( entry->first.Scalar() );
	}
	return names;
}

std::map<std::string, double> YamlNode::numberMap() const
{
	std::map<std::string, double> values;
	if ( defined() && !isMap() )
	{
		fail( "is not a map of names and numbers", "write {name: number, ...}" );
	}
	for ( auto entry = m_node.begin(); isMap() && entry != m_node.end(); ++entry )
	{
		if ( !entry->first.IsScalar() )
		{
			fail( "has a key that is no name", "write names and values" );
		}
		const std::string& name = entry->first.Scalar();
		values.emplace( name, child( entry->second, m_path.empty() ? name : m_path + "." + name ).number() );
	}
	return values;
}

std::vector<double> YamlNode::vector( std::initializer_list<const char*> keys ) const
{
	std::string expected;
	for ( const char* key : keys )
	{
		expected += ( expected.empty() ? "" : ", " ) + std::string( key );
	}
	std::string remedy = fmt::format( "write [{}] or {{{}: ...}}", expected, *keys.begin() );
	if ( isList() )
	{
		if ( m_node.size() != keys.size() )
		{
			fail( fmt::format( "has {} numbers, not {}", m_node.size(), keys.size() ), remedy );
		}
		return numberList();
	}
	if ( !isMap() )
	{
		fail( defined() ? "is neither a list nor a map" : "is missing", remedy );
	}
	if ( m_node.size() != keys.size() )
	{
		fail( fmt::format( "does not have exactly the keys {}", expected ), remedy );
	}
	std::vector<double> values;
	for ( const char* key : keys )
	{
		values.push_back( ( *this )[key].number() );
	}
	return values;
}

std::array<double, 4> YamlNode::quaternion() const
{
	std::vector<double> q = vector( { "x", "y", "z", "w" } );
	double norm = std::hypot( std::hypot( q[0], q[1] ), std::hypot( q[2], q[3] ) );
	// A shorter quaternion has no usable direction
	if ( !( norm > 1e-9 ) )
	{
		fail( "the quaternion is zero", "write [0, 0, 0, 1] for no rotation" );
	}
	if ( std::fabs( norm - 1 ) > quaternion_notice_threshold )
	{
		notice( fmt::format( "quaternion of length {:.6g} was normalised", norm ) );
	}
	return { q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm };
}

lw_transform YamlNode::pose() const
{
	if ( !isMap() )
	{
		fail( defined() ? "is not a pose" : "is missing", "write {position: [x, y, z], orientation: [x, y, z, w]}" );
	}
	for ( const auto& entry : m_node )
	{
		static const std::set<std::string> known = { "position", "orientation", "translation", "rotation" };
		if ( !entry.first.IsScalar() || known.count( entry.first.Scalar() ) == 0 )
		{
			fail( fmt::format( "a pose has no key {}", entry.first.IsScalar() ? entry.first.Scalar() : "like this" ),
			    "write position and orientation, or translation and rotation" );
		}
		if ( entry.second.IsNull() )
		{
			fail( fmt::format( "{} is empty", entry.first.Scalar() ),
			    "write its numbers, or remove the key: the file may be cut short" );
		}
	}
	YamlNode position = firstOf( { "position", "translation" } );
	YamlNode orientation = firstOf( { "orientation", "rotation" } );
	if ( !position.defined() && !orientation.defined() )
	{
		fail( "is an empty pose", "write position and orientation" );
	}
	std::vector<double> p( 3, 0.0 );
	if ( position.defined() )
	{
		p = position.vector( { "x", "y", "z" } );
	}
	for ( double coordinate : p )
	{
		if ( std::fabs( coordinate ) > LW_MAX_TRANSLATION )
		{
			position.fail( fmt::format( "{} is beyond {:g} m", coordinate, double( LW_MAX_TRANSLATION ) ), "give metres" );
		}
	}
	std::array<double, 4> q = { 0, 0, 0, 1 };
	if ( orientation.defined() )
	{
		q = orientation.quaternion();
	}
	lw_transform transform;
	require( lw_transform_from_quaternion( p.data(), q.data(), &transform ), "lw_transform_from_quaternion" );
	return transform;
}

std::string YamlNode::frame() const
{
	( *this )["header"].noticeUnknownKeys( { "frame_id", "seq", "stamp" } );
	YamlNode id = ( *this )["header"]["frame_id"];
	std::string name = id.textOr( "" );
	return !name.empty() && name[0] == '/' ? name.substr( 1 ) : name;
}

JointState readJointState( const YamlNode& state )
{
	JointState result;
	YamlNode joints = state["joint_state"];
	joints.noticeUnknownKeys( { "header", "name", "position", "velocity", "effort" } );
	joints.noticeUnused( { "velocity", "effort" }, "a state is where its joints are" );
	std::vector<std::string> names = joints["name"].textList();
	std::vector<double> positions = joints["position"].numberList();
	if ( names.size() != positions.size() )
	{
		joints.fail( fmt::format( "has {} names and {} positions", names.size(), positions.size() ),
		    "give one position for each name" );
	}
	for ( std::size_t i = 0; i < names.size(); ++i )
	{
		if ( !result.values.emplace( names[i], positions[i] ).second )
		{
			joints["name"][i].fail( fmt::format( "joint {} is there twice", names[i] ), "remove one of them" );
		}
	}
	YamlNode multi = state["multi_dof_joint_state"];
	multi.noticeUnknownKeys( { "header", "joint_names", "transforms", "twist", "wrench" } );
	multi.noticeUnused( { "twist", "wrench" }, "a state is where its joints are" );
	multi["header"].noticeUnused( { "frame_id" }, "transforms are those of the joints, from parent to child" );
	std::vector<std::string> multi_names = multi["joint_names"].textList();
	YamlNode transforms = multi["transforms"];
	if ( multi_names.size() != transforms.size() )
	{
		multi.fail( fmt::format( "has {} joint_names and {} transforms", multi_names.size(), transforms.size() ),
		    "give one transform for each joint" );
	}
	for ( std::size_t i = 0; i < multi_names.size(); ++i )
	{
		// Kept as the seven variables of a floating joint; a planar joint takes its three from them when it is known to be
		// one
		lw_transform pose = transforms[i].pose();
		double q[4];
		lw_transform_to_quaternion( &pose, q );
		const char* suffixes[7] = { "/trans_x", "/trans_y", "/trans_z", "/rot_x", "/rot_y", "/rot_z", "/rot_w" };
		double values[7] = { pose.t[0], pose.t[1], pose.t[2], q[0], q[1], q[2], q[3] };
		for ( std::size_t k = 0; k < 7; ++k )
		{
			result.values[multi_names[i] + suffixes[k]] = values[k];
		}
	}
	return result;
}

} // namespace leeway::io::detail

void leeway::io::requireSoundDocument(
    const std::string& file, const YAML::Node& root, std::size_t text_size, std::size_t first_line )
{
	detail::DocumentCheck( file, text_size, first_line ).visit( root );
}

/// Parses at most two documents. YAML::LoadAll() never ends on text that no document can begin with: it finds an empty
/// document there, again and again.
bool leeway::io::holdsSeveralDocuments( const std::string& text )
{
	if ( detail::isOneMap( text ) )
	{
		return false;
	}
	std::istringstream stream( text );
	YAML::Parser parser( stream );
	detail::Nobody nobody;
	return parser.HandleNextDocument( nobody ) && parser.HandleNextDocument( nobody );
}

bool leeway::io::saysNothing( const YAML::Node& value )
{
	if ( !value.IsDefined() )
	{
		return true;
	}
	if ( value.IsMap() )
	{
		return std::all_of( value.begin(), value.end(), []( const auto& entry ) { return saysNothing( entry.second ); } );
	}
	if ( value.IsSequence() )
	{
		return std::all_of(
		    value.begin(), value.end(), []( const YAML::Node& entry ) { return entry.IsScalar() && saysNothing( entry ); } );
	}
	const std::string text = value.IsScalar() ? value.Scalar() : "";
	return text.empty() || text == "false" || text == "False" || text.find_first_not_of( "0." ) == std::string::npos;
}
