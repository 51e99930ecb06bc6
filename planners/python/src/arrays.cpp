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

[[noreturn]] void refuse( const std::string& text )
{
	throw nb::value_error( text.c_str() );
}

/// str( object ) of Python.
std::string textOf( const nb::object& object )
{
	return nb::str( nb::handle( object ) ).c_str();
}

} // namespace

std::string shapeText( const Doubles& numbers )
{
	std::string text = "(";
	for ( std::size_t i = 0; i < numbers.dimensions(); ++i )
	{
		text += ( i > 0 ? ", " : "" ) + std::to_string( numbers.shape( i ) );
	}
	return text + ( numbers.dimensions() == 1 ? ",)" : ")" );
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

Indices indicesOf( nb::handle source, const char* name, const char* unit )
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
		refuse( std::string( name ) + ": is no array of integers" );
	}
	if ( isMasked( source ) )
	{
		refuse( std::string( name ) + ": is a masked array, whose mask would be lost; give .compressed() or .filled()" );
	}
	if ( nb::cast<std::size_t>( given.attr( "size" ) ) > 0 )
	{
		const nb::object type = given.attr( "dtype" );
		const std::string kind = textOf( type.attr( "kind" ) );
		if ( kind != "i" && kind != "u" )
		{
			refuse( std::string( name ) + ": numbers of type " + textOf( type ) + " are no indices of " + unit +
			        "; give integers" );
		}
		for ( const char* extreme : { "min", "max" } )
		{
			const nb::object value = nb::int_( given.attr( extreme )() );
			if ( value < nb::int_( 0 ) || value > nb::int_( std::numeric_limits<std::uint32_t>::max() ) )
			{
				refuse( std::string( name ) + ": " + textOf( value ) + " is no index of " + unit + "; they are counted from 0" );
			}
		}
	}
	if ( !nb::try_cast( numpy.attr( "ascontiguousarray" )( given, "uint32" ), indices.array, false ) )
	{
		refuse( std::string( name ) + ": is no array of integers" );
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

lw_transform poseOf( const Doubles& numbers, const char* name )
{
	lw_transform pose = lw_transform_identity();
	const double* p = numbers.data();
	if ( numbers.dimensions() == 2 && numbers.shape( 0 ) == 4 && numbers.shape( 1 ) == 4 )
	{
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
			refuse( std::string( name ) + ": the matrix is no rigid motion; write rotation | translation over 0 0 0 1" );
		}
		return pose;
	}
	if ( numbers.dimensions() == 1 && ( numbers.shape( 0 ) == 3 || numbers.shape( 0 ) == 7 ) )
	{
		const double none[4] = { 0, 0, 0, 1 };
		const double* quaternion = numbers.shape( 0 ) == 7 ? p + 3 : none;
		if ( lw_transform_from_quaternion( p, quaternion, &pose ) != LW_OK || !lw_transform_is_valid( &pose ) )
		{
			refuse( std::string( name ) + ": a number is not finite or too large, or the quaternion is zero" );
		}
		return pose;
	}
	refuse( std::string( name ) + ": shape " + shapeText( numbers ) +
	        " is none of (4, 4), a matrix; (3,), a position; (7,), a position and a quaternion x, y, z, w" );
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
template struct NewArray<std::uint8_t>;
template struct NewArray<bool>;

nb::object poseArray( const lw_transform& transform )
{
	const NewArray<double> array( { 4, 4 } );
	writePose( transform, array.data );
	return array.object;
}

} // namespace leeway::python
