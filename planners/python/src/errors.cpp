// SPDX-License-Identifier: BSD-3-Clause
// Exceptions. Messages are those of the library; the parts of a message are attributes.
#include "errors.hpp"

#include "leeway/io/model.hpp"
#include "leeway/planners/planner.hpp"

namespace leeway::python
{

namespace nb = nanobind;

namespace
{

/// Classes live as long as the interpreter.
struct Classes
{
	PyObject *error = nullptr, *input = nullptr, *core = nullptr;
};
Classes classes;

PyObject* newClass( nb::module_& module, const char* name, const char* doc, const nb::handle& bases )
{
	const std::string full = std::string( "leeway._core." ) + name;
	PyObject* made = PyErr_NewExceptionWithDoc( full.c_str(), doc, bases.ptr(), nullptr );
	if ( made == nullptr )
	{
		throw nb::python_error();
	}
	module.attr( name ) = nb::borrow( made );
	return made;
}

/// Bytes of files and of their names need not be UTF-8.
nb::object text( const std::string& value )
{
	return nb::steal( PyUnicode_DecodeUTF8( value.data(), static_cast<Py_ssize_t>( value.size() ), "backslashreplace" ) );
}

void raise(
    PyObject* type, const std::string& message, std::initializer_list<std::pair<const char*, nb::object>> attributes )
{
	const nb::object instance = nb::borrow( type )( text( message ) );
	for ( const auto& [name, value] : attributes )
	{
		nb::setattr( instance, name, value );
	}
	PyErr_SetObject( type, instance.ptr() );
}

void translate( const std::exception_ptr& thrown, void* )
{
	try
	{
		std::rethrow_exception( thrown );
	}
	catch ( const io::Error& error )
	{
		raise( classes.input, error.what(),
		    { { "file", text( error.file() ) }, { "element", text( error.element() ) },
		        { "problem", text( error.problem() ) }, { "remedy", text( error.remedy() ) } } );
	}
	catch ( const CoreError& error )
	{
		if ( error.status() == LW_ERROR_OUT_OF_MEMORY )
		{
			PyErr_SetString( PyExc_MemoryError, error.what() );
			return;
		}
		raise( classes.core, error.what(), { { "status", text( lw_status_name( error.status() ) ) } } );
	}
	catch ( const planners::InputError& error )
	{
		raise( classes.core, error.what(), { { "status", text( lw_status_name( LW_ERROR_INVALID_ARGUMENT ) ) } } );
	}
}

} // namespace

void bindErrors( nb::module_& module )
{
	classes.error = newClass(
	    module, "Error", "Base class of all errors of the library. A ValueError.", nb::handle( PyExc_ValueError ) );
	classes.input = newClass( module, "InputError",
	    "A file or a named part of a model that cannot be used. The text is \"file: element: problem; remedy\";\n"
	    "its parts are the attributes file, element, problem and remedy.",
	    nb::handle( classes.error ) );
	classes.core = newClass( module, "CoreError",
	    "A call that failed. The attribute status is the name of the library's status, such as LW_ERROR_BAD_GEOMETRY.",
	    nb::handle( classes.error ) );
	nb::register_exception_translator( translate );
}

} // namespace leeway::python
