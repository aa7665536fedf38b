#include "base/zip/zip_library.hpp"

namespace pliant {

ZipLibrary::ZipLibrary() : LoadedLibrary(PLIANT_LIBZIP) {
    find("zip_open", open);
    find("zip_discard", discard);
    find("zip_error_init_with_code", error_init_with_code);
    find("zip_error_strerror", error_strerror);
    find("zip_error_fini", error_fini);
    find("zip_get_num_entries", get_num_entries);
    find("zip_get_name", get_name);
    find("zip_name_locate", name_locate);
    find("zip_stat_init", stat_init);
    find("zip_stat", stat);
    find("zip_fopen", fopen);
    find("zip_fclose", fclose);
    find("zip_fread", fread);
    find("zip_file_strerror", file_strerror);
    find("zip_strerror", strerror);
}

const ZipLibrary& ZipLibrary::instance() {
    static const ZipLibrary library;
    return library;
}

}  // namespace pliant
