#include "base/zip/zip_library.hpp"

namespace pliant {

ZipLibrary::ZipLibrary() : library_(name()) {
    library_.find("zip_open", open);
    library_.find("zip_discard", discard);
    library_.find("zip_error_init_with_code", error_init_with_code);
    library_.find("zip_error_strerror", error_strerror);
    library_.find("zip_error_fini", error_fini);
    library_.find("zip_get_num_entries", get_num_entries);
    library_.find("zip_get_name", get_name);
    library_.find("zip_name_locate", name_locate);
    library_.find("zip_stat_init", stat_init);
    library_.find("zip_stat", stat);
    library_.find("zip_fopen", fopen);
    library_.find("zip_fclose", fclose);
    library_.find("zip_fread", fread);
    library_.find("zip_file_strerror", file_strerror);
    library_.find("zip_strerror", strerror);
}

const ZipLibrary& ZipLibrary::instance() {
    static const ZipLibrary library;
    return library;
}

const char* ZipLibrary::name() {
    return PLIANT_LIBZIP;
}

}  // namespace pliant
