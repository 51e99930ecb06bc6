// SPDX-License-Identifier: BSD-3-Clause
// Arrays between NumPy and the library: arguments without a copy where NumPy allows it, results in memory that NumPy owns.
#pragma once

#include "leeway/math.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <vector>

namespace leeway::python
{

namespace nb = nanobind;

/// An argument as numbers of type T. NumPy arrays of this type in C order are not copied; of anything else that NumPy can make an array of,
/// real numbers are converted. Complex numbers, texts and masked arrays are refused. The memory lives as long as this object.
template <typename T> struct Numbers
{
	nb::ndarray<const T, nb::c_contig, nb::device::cpu> array;
	std::size_t dimensions() const { return array.ndim(); }
	std::size_t shape( std::size_t i ) const { return array.shape( i ); }
	std::size_t size() const { return array.size(); }
	const T* data() const { return array.data(); }
};
using Doubles = Numbers<double>;
using Indices = Numbers<std::uint32_t>;

/// A masked array of NumPy's. By its name: an import for each argument costs more than a small question.
bool isMasked( nb::handle source );

/// Integers of an argument, each in [0, count). Nothing is rounded or wrapped: numbers of another type than integers are refused, bools too.
/// @param name of the argument @param unit of which they are indices, such as "vertices" @param count of these, at most 2^32
/// @throws nb::value_error that names the argument, the first entry that is wrong, its value and the range
Indices indicesOf( nb::handle source, const char* name, const char* unit, std::size_t count );

/// A count, seed or another whole number of an argument: any object that Python takes as an index, but no bool.
struct Whole
{
	nb::handle given;
	/// @param name of the argument @throws nb::value_error that names it, the value and the range
	std::uint64_t in( const char* name, std::uint64_t least, std::uint64_t most ) const;
	/// Threads side by side; 0 = one per core.
	unsigned threads() const { return static_cast<unsigned>( in( "threads", 0, most_threads ) ); }
	/// Any number of 64 bits.
	std::uint64_t seed() const;
	static constexpr std::uint64_t most_threads = 4096;
};

/// "(100, 6)"
template <typename T> std::string shapeText( const Numbers<T>& numbers )
{
	std::string text = "(";
	for ( std::size_t i = 0; i < numbers.dimensions(); ++i )
	{
		text += ( i > 0 ? ", " : "" ) + std::to_string( numbers.shape( i ) );
	}
	return text + ( numbers.dimensions() == 1 ? ",)" : ")" );
}

/// Rows of an argument: [n, width], or one row [width].
struct Rows
{
	const double* data = nullptr;
	std::size_t count = 0, width = 0;
	bool single = false; ///< the argument was one row
	const double* operator[]( std::size_t i ) const { return data + i * width; }
};

/// @param name of the argument, for the message @param unit of a row, such as "variables of the group"
/// @throws nb::value_error for another shape
Rows rowsOf( const Doubles& numbers, std::size_t width, const char* name, const char* unit );

/// Numbers [size] of an argument. @throws nb::value_error for another shape
const double* vectorOf( const Doubles& numbers, std::size_t size, const char* name, const char* unit );

/// A pose: 4 x 4 matrix; or position [3]; or position and quaternion x, y, z, qx, qy, qz, qw [7].
/// @throws nb::value_error for another shape, a matrix that is no rigid motion, or a number that is not finite
lw_transform poseOf( const Doubles& numbers, const char* name );
/// Poses in order: 4 x 4 matrices [n, 4, 4], positions and quaternions [n, 7], or one as for poseOf(). @throws nb::value_error naming the index
std::vector<lw_transform> posesOf( const Doubles& numbers, const char* name );
/// As poseOf(); None is the identity.
lw_transform poseOrIdentity( const nb::object& pose, const char* name );
/// Writes the 4 x 4 matrix of a transform.
void writePose( const lw_transform& transform, double* out );

/// A new NumPy array that owns its memory. T: double, std::int32_t, std::int64_t, std::uint8_t or bool.
template <typename T> struct NewArray
{
	explicit NewArray( std::initializer_list<std::size_t> shape );
	T* data;
	nb::object object;
};

/// A read-only NumPy array of memory that `owner` keeps alive.
template <typename T> nb::object viewOf( const T* data, std::initializer_list<std::size_t> shape, nb::handle owner )
{
	return nb::cast( nb::ndarray<nb::numpy, const T>( data, shape.size(), shape.begin(), owner ), nb::rv_policy::reference );
}

/// The 4 x 4 matrix of a transform.
nb::object poseArray( const lw_transform& transform );

/// Three numbers of a result.
inline void write( double* out, lw_vec3 v )
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

} // namespace leeway::python

namespace nanobind::detail
{

template <typename T> struct type_caster<leeway::python::Numbers<T>>
{
	// cppcheck-suppress unknownMacro
	NB_TYPE_CASTER( leeway::python::Numbers<T>, const_name( "numpy.typing.ArrayLike" ) )

	template <typename Flags> bool from_python( handle source, Flags, cleanup_list* ) noexcept
	{
		if ( source.is_none() )
		{
			return false;
		}
		if ( leeway::python::isMasked( source ) )
		{
			return false; // its mask would be lost
		}
		if ( try_cast( source, value.array, false ) )
		{
			return true;
		}
		try
		{
			const module_ numpy = module_::import_( "numpy" );
			const object given = numpy.attr( "asarray" )( source );
			const object real = numpy.attr( "can_cast" )(
			    given.attr( "dtype" ), std::is_same_v<T, double> ? "float64" : "uint32", "same_kind" );
			return cast<bool>( real ) &&
			       try_cast( numpy.attr( "ascontiguousarray" )( given, std::is_same_v<T, double> ? "float64" : "uint32" ),
			           value.array, false );
		}
		catch ( ... )
		{
			return false; // nanobind lists the types that the function takes
		}
	}
	static handle from_cpp( const leeway::python::Numbers<T>&, rv_policy, cleanup_list* ) noexcept { return {}; }
};

/// Takes any object: Whole refuses it with the argument's name.
template <> struct type_caster<leeway::python::Whole>
{
	NB_TYPE_CASTER( leeway::python::Whole, const_name( "int" ) )

	bool from_python( handle source, std::uint8_t, cleanup_list* ) noexcept
	{
		value.given = source;
		return true;
	}
	static handle from_cpp( const leeway::python::Whole&, rv_policy, cleanup_list* ) noexcept { return {}; }
};

} // namespace nanobind::detail
