#include "files.hpp"
