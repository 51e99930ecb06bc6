// SPDX-License-Identifier: BSD-3-Clause
// C++ reads atomic fields as std::atomic: a struct must be laid out as C lays it out.
#include "layout.h"

#include <gtest/gtest.h>

#include <iterator>

TEST( Layout, CppDiffersFromC )
{
	const layout cpp[] = { LAYOUTS( LAYOUT_OF ) };
	std::size_t count;
	const layout* c = layouts_of_c( &count );
	ASSERT_EQ( count, std::size( cpp ) );
	for ( std::size_t i = 0; i < count; ++i )
	{
		EXPECT_EQ( c[i].size, cpp[i].size ) << c[i].type;
		EXPECT_EQ( c[i].offset, cpp[i].offset ) << c[i].type;
	}
}
