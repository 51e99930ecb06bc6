// SPDX-License-Identifier: BSD-3-Clause
// check_certificate.c for many files: names of certificates in, a line with the exit status of each out. A fork for each costs a tenth of a program.
#define main check_main
#define link check_link // unistd.h has one
#include "../../planners/certify/check_certificate.c"
#undef main
#undef link

#include <sys/wait.h>
#include <unistd.h>

int main( void )
{
	char line[4096];
	while ( fgets( line, sizeof( line ), stdin ) )
	{
		line[strcspn( line, "\n" )] = 0;
		int status = 0;
		const pid_t child = fork();
		if ( child == 0 )
		{
			char name[] = "check";
			char* arguments[] = { name, line, NULL };
			if ( !freopen( "/dev/null", "w", stdout ) )
			{
				_exit( 3 );
			}
			exit( check_main( 2, arguments ) );
		}
		if ( child < 0 || waitpid( child, &status, 0 ) != child )
		{
			return 1;
		}
		printf( "%d\n", WIFEXITED( status ) ? WEXITSTATUS( status ) : -1 );
		fflush( stdout );
	}
	return 0;
}
