// libzip, loaded when the first archive is read: it brings OpenSSL.
#pragma once

#include <zip.h>

#include "base/core/loaded_library.hpp"

namespace pliant {

/// The functions in use, by their names in libzip without "zip_".
class ZipLibrary : public LoadedLibrary {
public:
    /// The library of this process.
    [[nodiscard]] static const ZipLibrary& instance();

    decltype(&zip_open) open = nullptr;
    decltype(&zip_discard) discard = nullptr;
    decltype(&zip_error_init_with_code) error_init_with_code = nullptr;
    decltype(&zip_error_strerror) error_strerror = nullptr;
    decltype(&zip_error_fini) error_fini = nullptr;
    decltype(&zip_get_num_entries) get_num_entries = nullptr;
    decltype(&zip_get_name) get_name = nullptr;
    decltype(&zip_name_locate) name_locate = nullptr;
    decltype(&zip_stat_init) stat_init = nullptr;
    decltype(&zip_stat) stat = nullptr;
    decltype(&zip_fopen) fopen = nullptr;
    decltype(&zip_fclose) fclose = nullptr;
    decltype(&zip_fread) fread = nullptr;
    decltype(&zip_file_strerror) file_strerror = nullptr;
    decltype(&zip_strerror) strerror = nullptr;

private:
    ZipLibrary();
};

}  // namespace pliant
