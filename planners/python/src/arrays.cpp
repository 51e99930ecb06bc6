// SPDX-License-Identifier: BSD-3-Clause
// Arrays: see arrays.hpp.
#include "arrays.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

[[noreturn]] void refuse( const std::string& text )
{
	throw nb::value_error( text.c_str() );
}

/// str( object ) of Python.
std::string textOf( const nb::object& object )
{
	return nb::str( nb::handle( object ) ).c_str();
}

/// repr( object ) of Python, cut to a line.
std::string shown( nb::handle object )
{
	constexpr std::size_t most = 60;
	const std::string text = nb::repr( object ).c_str();
	return text.size() <= most ? text : text.substr( 0, most - 4 ) + " ...";
}

/// A bool of Python or of NumPy.
bool isBool( nb::handle object )
{
	return PyBool_Check( object.ptr() ) || std::strncmp( Py_TYPE( object.ptr() )->tp_name, "numpy.bool", 10 ) == 0;
}

/// "[5, 2]", the place of a number in an array of this shape. @param index in C order
std::string placeText( const nb::object& array, std::size_t index )
{
	const nb::module_ numpy = nb::module_::import_( "numpy" );
	std::string text = "[";
	for ( const nb::handle i : numpy.attr( "unravel_index" )( index, array.attr( "shape" ) ) )
	{
		text += ( text.size() > 1 ? ", " : "" ) + textOf( nb::int_( nb::borrow( i ) ) );
	}
	return text + "]";
}

/// Refuses one number of an array of indices.
[[noreturn]] void refuseIndex(
    const std::string& name, const std::string& place, const std::string& problem, const char* unit, std::size_t count )
{
	const std::string range = count == 0 ? std::string( "none, as there are no " ) + unit
	                                     : "whole numbers from 0 to " + std::to_string( count - 1 ) + ", indices of " + unit;
	refuse( name + place + ": " + problem + "; give " + range );
}

/// NumPy takes True of a list as 1, and makes all of a list fractions for one of them. @param source of which `given` was made
void refuseEntries( nb::handle source, const nb::object& given, const char* name, const char* unit, std::size_t count )
{
	if ( nb::hasattr( source, "dtype" ) )
	{
		return; // its type says it
	}
	const nb::object entries =
	    nb::module_::import_( "numpy" ).attr( "array" )( source, "dtype"_a = "object" ).attr( "ravel" )();
	const std::string kind = textOf( given.attr( "dtype" ).attr( "kind" ) );
	const bool large = kind != "i" && kind != "u"; // more than 64 bits
	std::size_t i = 0;
	for ( const nb::handle entry : entries )
	{
		if ( isBool( entry ) || !PyIndex_Check( entry.ptr() ) )
		{
			refuseIndex( name, placeText( given, i ), "is " + shown( entry ) + ", no whole number", unit, count );
		}
		if ( large &&
		     ( nb::int_( nb::borrow( entry ) ) < nb::int_( 0 ) || nb::int_( nb::borrow( entry ) ) >= nb::int_( count ) ) )
		{
			refuseIndex( name, placeText( given, i ), "is " + shown( entry ), unit, count );
		}
		++i;
	}
}

/// The array has only integers: each must be in [0, count).
void refuseOutside( const nb::object& given, const char* name, const char* unit, std::size_t count )
{
	const nb::object least = nb::int_( given.attr( "min" )() ), greatest = nb::int_( given.attr( "max" )() );
	const bool low = least < nb::int_( 0 );
	if ( !low && greatest < nb::int_( count ) )
	{
		return;
	}
	const nb::module_ numpy = nb::module_::import_( "numpy" );
	const nb::object wrong = low ? numpy.attr( "less" )( given, 0 ) : numpy.attr( "greater_equal" )( given, count );
	const auto index = nb::cast<std::size_t>( nb::int_( wrong.attr( "argmax" )() ) );
	refuseIndex( name, placeText( given, index ), "is " + textOf( given.attr( "item" )( index ) ), unit, count );
}

} // namespace

std::uint64_t Whole::in( const char* name, std::uint64_t least, std::uint64_t most ) const
{
	const std::string range = "; give a whole number from " + std::to_string( least ) + " to " + std::to_string( most );
	nb::object number;
	if ( !isBool( given ) )
	{
		number = nb::steal( PyNumber_Index( given.ptr() ) );
		if ( !number.is_valid() )
		{
			PyErr_Clear();
		}
	}
	if ( !number.is_valid() )
	{
		refuse( std::string( name ) + ": is " + shown( given ) + ", no whole number" + range );
	}
	if ( number < nb::int_( least ) || number > nb::int_( most ) )
	{
		refuse( std::string( name ) + ": is " + shown( number ) + range );
	}
	return nb::cast<std::uint64_t>( number );
}

std::uint64_t Whole::seed() const
{
	return in( "seed", 0, std::numeric_limits<std::uint64_t>::max() );
}

Rows rowsOf( const Doubles& numbers, std::size_t width, const char* name, const char* unit )
{
	const bool single = numbers.dimensions() == 1;
	if ( ( !single && numbers.dimensions() != 2 ) || numbers.shape( single ? 0 : 1 ) != width )
	{
		refuse( std::string( name ) + ": shape " + shapeText( numbers ) + " is neither (" + std::to_string( width ) +
		        ",) nor (n, " + std::to_string( width ) + "): " + std::to_string( width ) + " " + unit );
	}
	return { numbers.data(), single ? 1 : numbers.shape( 0 ), width, single };
}

bool isMasked( nb::handle source )
{
	return std::strstr( Py_TYPE( source.ptr() )->tp_name, "MaskedArray" ) != nullptr;
}

Indices indicesOf( nb::handle source, const char* name, const char* unit, std::size_t count )
{
	const nb::module_ numpy = nb::module_::import_( "numpy" );
	Indices indices;
	nb::object given;
	try
	{
		given = numpy.attr( "asarray" )( source );
	}
	catch ( const nb::python_error& )
	{
		refuse( std::string( name ) + ": is no array of integers; give rows of equal lengths" );
	}
	if ( isMasked( source ) )
	{
		refuse( std::string( name ) + ": is a masked array, whose mask would be lost; give .compressed() or .filled()" );
	}
	if ( nb::cast<std::size_t>( given.attr( "size" ) ) > 0 )
	{
		refuseEntries( source, given, name, unit, count );
		const nb::object type = given.attr( "dtype" );
		const std::string kind = textOf( type.attr( "kind" ) );
		if ( kind != "i" && kind != "u" )
		{
			refuseIndex( name, placeText( given, 0 ),
			    "is " + shown( given.attr( "item" )( 0 ) ) + " of type " + textOf( type ), unit, count );
		}
		refuseOutside( given, name, unit, count );
	}
	if ( !nb::try_cast( numpy.attr( "ascontiguousarray" )( given, "uint32" ), indices.array, false ) )
	{
		refuse( std::string( name ) + ": is no array of integers; give rows of equal lengths" );
	}
	return indices;
}

const double* vectorOf( const Doubles& numbers, std::size_t size, const char* name, const char* unit )
{
	if ( numbers.dimensions() != 1 || numbers.shape( 0 ) != size )
	{
		refuse( std::string( name ) + ": shape " + shapeText( numbers ) + " is not (" + std::to_string( size ) +
		        ",): " + std::to_string( size ) + " " + unit );
	}
	return numbers.data();
}

namespace
{

/// Of 4 x 4 numbers.
lw_transform ofMatrix( const double* p, const std::string& name )
{
	lw_transform pose;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			pose.r[i][j] = p[4 * i + j];
		}
		pose.t[i] = p[4 * i + 3];
	}
	const bool bottom = p[12] == 0 && p[13] == 0 && p[14] == 0 && p[15] == 1;
	if ( !bottom || !lw_transform_is_valid( &pose ) )
	{
		refuse( name + ": the matrix is no rigid motion; write rotation | translation over 0 0 0 1" );
	}
	return pose;
}

lw_transform ofQuaternion( const double* position, const double* quaternion, const std::string& name )
{
	lw_transform pose;
	if ( lw_transform_from_quaternion( position, quaternion, &pose ) != LW_OK || !lw_transform_is_valid( &pose ) )
	{
		refuse( name + ": a number is not finite or too large, or the quaternion is zero" );
	}
	return pose;
}

} // namespace

lw_transform poseOf( const Doubles& numbers, const char* name )
{
	const double* p = numbers.data();
	if ( numbers.dimensions() == 2 && numbers.shape( 0 ) == 4 && numbers.shape( 1 ) == 4 )
	{
		return ofMatrix( p, name );
	}
	if ( numbers.dimensions() == 1 && ( numbers.shape( 0 ) == 3 || numbers.shape( 0 ) == 7 ) )
	{
		const double none[4] = { 0, 0, 0, 1 };
		return ofQuaternion( p, numbers.shape( 0 ) == 7 ? p + 3 : none, name );
	}
	refuse( std::string( name ) + ": shape " + shapeText( numbers ) +
	        " is none of (4, 4), a matrix; (3,), a position; (7,), a position and a quaternion x, y, z, w" );
}

std::vector<lw_transform> posesOf( const Doubles& numbers, const char* name )
{
	const std::size_t dimensions = numbers.dimensions();
	const bool matrices = dimensions == 3 && numbers.shape( 1 ) == 4 && numbers.shape( 2 ) == 4;
	const bool one_matrix = dimensions == 2 && numbers.shape( 0 ) == 4 && numbers.shape( 1 ) == 4;
	if ( dimensions == 1 || one_matrix )
	{
		return { poseOf( numbers, name ) };
	}
	if ( !matrices && !( dimensions == 2 && numbers.shape( 1 ) == 7 ) )
	{
		refuse( std::string( name ) + ": shape " + shapeText( numbers ) +
		        " is none of (n, 4, 4), matrices; (n, 7), positions and quaternions x, y, z, w; or one pose" );
	}
	std::vector<lw_transform> poses;
	poses.reserve( numbers.shape( 0 ) );
	for ( std::size_t i = 0; i < numbers.shape( 0 ); ++i )
	{
		const double* p = numbers.data() + ( matrices ? 16 : 7 ) * i;
		const std::string which = std::string( name ) + "[" + std::to_string( i ) + "]";
		poses.push_back( matrices ? ofMatrix( p, which ) : ofQuaternion( p, p + 3, which ) );
	}
	return poses;
}

lw_transform poseOrIdentity( const nb::object& pose, const char* name )
{
	if ( pose.is_none() )
	{
		return lw_transform_identity();
	}
	Doubles numbers;
	if ( !nb::try_cast( pose, numbers ) )
	{
		refuse( std::string( name ) + ": is no array of numbers" );
	}
	return poseOf( numbers, name );
}

void writePose( const lw_transform& transform, double* out )
{
	for ( int i = 0; i < 3; ++i )
	{
		std::memcpy( out + 4 * i, transform.r[i], 3 * sizeof( double ) );
		out[4 * i + 3] = transform.t[i];
	}
	const double bottom[4] = { 0, 0, 0, 1 };
	std::memcpy( out + 12, bottom, sizeof( bottom ) );
}

template <typename T> NewArray<T>::NewArray( std::initializer_list<std::size_t> shape )
{
	std::size_t size = 1;
	for ( std::size_t n : shape )
	{
		size *= n;
	}
	std::unique_ptr<T[]> memory( new T[size > 0 ? size : 1] );
	data = memory.get();
	const nb::capsule owner( data, []( void* p ) noexcept { delete[] static_cast<T*>( p ); } );
	memory.release();
	object = nb::cast( nb::ndarray<nb::numpy, T>( data, shape.size(), shape.begin(), owner ), nb::rv_policy::reference );
}

template struct NewArray<double>;
template struct NewArray<std::int32_t>;
template struct NewArray<std::int64_t>;
template struct NewArray<std::uint8_t>;
template struct NewArray<bool>;

nb::object poseArray( const lw_transform& transform )
{
	const NewArray<double> array( { 4, 4 } );
	writePose( transform, array.data );
	return array.object;
}

} // namespace leeway::python
