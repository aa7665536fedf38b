// Cairo, loaded when the first canvas is made: it brings two dozen other libraries.
#pragma once

#include <cairo.h>

#include "base/core/loaded_library.hpp"

namespace pliant::report {

/// The functions in use, by their names in Cairo.
class CairoLibrary : public LoadedLibrary {
public:
    CairoLibrary();

    decltype(&cairo_image_surface_create) image_surface_create = nullptr;
    decltype(&cairo_image_surface_get_data) image_surface_get_data = nullptr;
    decltype(&cairo_image_surface_get_width) image_surface_get_width = nullptr;
    decltype(&cairo_image_surface_get_height) image_surface_get_height = nullptr;
    decltype(&cairo_image_surface_get_stride) image_surface_get_stride = nullptr;
    decltype(&cairo_surface_flush) surface_flush = nullptr;
    decltype(&cairo_surface_mark_dirty) surface_mark_dirty = nullptr;
    decltype(&cairo_surface_write_to_png_stream) surface_write_to_png_stream = nullptr;
    decltype(&cairo_surface_destroy) surface_destroy = nullptr;
    decltype(&cairo_status_to_string) status_to_string = nullptr;
    decltype(&cairo_create) create = nullptr;
    decltype(&cairo_destroy) destroy = nullptr;
    decltype(&cairo_scale) scale = nullptr;
    decltype(&cairo_set_source_rgb) set_source_rgb = nullptr;
    decltype(&cairo_set_source_rgba) set_source_rgba = nullptr;
    decltype(&cairo_paint) paint = nullptr;
    decltype(&cairo_new_path) new_path = nullptr;
    decltype(&cairo_move_to) move_to = nullptr;
    decltype(&cairo_line_to) line_to = nullptr;
    decltype(&cairo_arc) arc = nullptr;
    decltype(&cairo_close_path) close_path = nullptr;
    decltype(&cairo_fill) fill = nullptr;
    decltype(&cairo_stroke) stroke = nullptr;
    decltype(&cairo_set_line_width) set_line_width = nullptr;
    decltype(&cairo_set_line_cap) set_line_cap = nullptr;
    decltype(&cairo_set_line_join) set_line_join = nullptr;
    decltype(&cairo_select_font_face) select_font_face = nullptr;
    decltype(&cairo_set_font_size) set_font_size = nullptr;
    decltype(&cairo_text_extents) text_extents = nullptr;
    decltype(&cairo_show_text) show_text = nullptr;
};

}  // namespace pliant::report
