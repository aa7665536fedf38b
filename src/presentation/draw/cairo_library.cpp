#include "presentation/draw/cairo_library.hpp"

namespace pliant::report {

CairoLibrary::CairoLibrary() : LoadedLibrary("libcairo.so.2") {
    find("cairo_image_surface_create", image_surface_create);
    find("cairo_image_surface_get_data", image_surface_get_data);
    find("cairo_image_surface_get_width", image_surface_get_width);
    find("cairo_image_surface_get_height", image_surface_get_height);
    find("cairo_image_surface_get_stride", image_surface_get_stride);
    find("cairo_surface_flush", surface_flush);
    find("cairo_surface_mark_dirty", surface_mark_dirty);
    find("cairo_surface_write_to_png_stream", surface_write_to_png_stream);
    find("cairo_surface_destroy", surface_destroy);
    find("cairo_status_to_string", status_to_string);
    find("cairo_create", create);
    find("cairo_destroy", destroy);
    find("cairo_scale", scale);
    find("cairo_set_source_rgb", set_source_rgb);
    find("cairo_set_source_rgba", set_source_rgba);
    find("cairo_paint", paint);
    find("cairo_new_path", new_path);
    find("cairo_move_to", move_to);
    find("cairo_line_to", line_to);
    find("cairo_arc", arc);
    find("cairo_close_path", close_path);
    find("cairo_fill", fill);
    find("cairo_stroke", stroke);
    find("cairo_set_line_width", set_line_width);
    find("cairo_set_line_cap", set_line_cap);
    find("cairo_set_line_join", set_line_join);
    find("cairo_select_font_face", select_font_face);
    find("cairo_set_font_size", set_font_size);
    find("cairo_text_extents", text_extents);
    find("cairo_show_text", show_text);
}

}  // namespace pliant::report
