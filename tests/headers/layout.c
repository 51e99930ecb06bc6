// SPDX-License-Identifier: BSD-3-Clause
#include "layout.h"

const layout* layouts_of_c( size_t* count )
{
	static const layout all[] = { LAYOUTS( LAYOUT_OF ) };
	*count = sizeof( all ) / sizeof( all[0] );
	return all;
}
