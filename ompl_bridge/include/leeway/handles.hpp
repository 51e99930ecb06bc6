// SPDX-License-Identifier: BSD-3-Clause
// Owning C++ handles of the core's objects, and core statuses as exceptions. Header only; needs nothing but the core.
#pragma once

#include "leeway/leeway.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace leeway
{

/// Failure of a core call, with its status and message.
class CoreError : public std::runtime_error
{
public:
	CoreError( lw_status status, const std::string& message ) : std::runtime_error( message ), m_status( status ) {}
	lw_status status() const { return m_status; }

private:
	lw_status m_status;
};

/// Throws CoreError with the diagnosis' message if `status` is not LW_OK.
inline void require( lw_status status, const lw_diag& diag )
{
	if ( status != LW_OK )
	{
		throw CoreError( status, diag.message[0] != '\0' ? diag.message : lw_status_name( status ) );
	}
}

inline void require( lw_status status, const char* what )
{
	if ( status != LW_OK )
	{
		throw CoreError( status, std::string( what ) + ": " + lw_status_name( status ) );
	}
}

/// A shared reference to a reference-counted core object; copying retains, destruction releases. const access only:
/// core objects are immutable.
template <typename T, T* ( *Retain )(const T*), void ( *Release )( T* )> class Ref
{
public:
	Ref() = default;
	/// Takes over the reference that the caller holds, such as the result of lw_*_create().
	static Ref adopt( T* object )
	{
		Ref ref;
		ref.m_object = object;
		return ref;
	}
	Ref( const Ref& other ) : m_object( Retain( other.m_object ) ) {}
	Ref( Ref&& other ) noexcept : m_object( std::exchange( other.m_object, nullptr ) ) {}
	Ref& operator=( Ref other ) noexcept
	{
		std::swap( m_object, other.m_object );
		return *this;
	}
	~Ref() { Release( m_object ); }
	const T* get() const { return m_object; }
	explicit operator bool() const { return m_object != nullptr; }

private:
	T* m_object = nullptr;
};

using Shape = Ref<lw_shape, lw_shape_retain, lw_shape_release>;
using Robot = Ref<lw_robot, lw_robot_retain, lw_robot_release>;
using Scene = Ref<lw_scene, lw_scene_retain, lw_scene_release>;
using Checker = Ref<lw_checker, lw_checker_retain, lw_checker_release>;
using Reach = Ref<lw_reach, lw_reach_retain, lw_reach_release>;

struct Deleter
{
	void operator()( lw_query* query ) const { lw_query_destroy( query ); }
	void operator()( lw_region* region ) const { lw_region_destroy( region ); }
	void operator()( lw_guard* guard ) const { lw_guard_destroy( guard ); }
};
/// Working memory of one thread.
using Query = std::unique_ptr<lw_query, Deleter>;
using RegionHandle = std::unique_ptr<lw_region, Deleter>;
using GuardHandle = std::unique_ptr<lw_guard, Deleter>;

/// A query for this checker (and its scene).
inline Query makeQuery( const lw_checker* checker, const lw_query_def& def = lw_query_def_default() )
{
	lw_query* query = nullptr;
	require( lw_query_create( &def, nullptr, checker, nullptr, &query ), "lw_query_create" );
	return Query( query );
}

} // namespace leeway
