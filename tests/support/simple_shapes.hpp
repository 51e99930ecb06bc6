// SPDX-License-Identifier: BSD-3-Clause
// Shapes in one line, for models that take shapes over.
#pragma once

#include "leeway/shape.h"
#include "poses.hpp"

#include <gtest/gtest.h>
#include <vector>

/// A primitive that the caller owns.
inline lw_shape* primitive( lw_shape_type type, double x, double y = 0, double z = 0 )
{
	const double dimensions[3] = { x, y, z };
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_primitive( type, dimensions, nullptr, nullptr, &shape ) );
	return shape;
}

/// A mesh that the caller owns.
inline lw_shape* meshOf( const std::vector<double>& vertices, const std::vector<std::uint32_t>& indices )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( vertices.size() / 3 );
	def.indices = indices.data();
	def.triangle_count = static_cast<std::uint32_t>( indices.size() / 3 );
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, nullptr, &shape ) );
	return shape;
}
