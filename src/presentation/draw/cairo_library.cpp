#include "presentation/draw/cairo_library.hpp"

namespace pliant::report {

CairoLibrary::CairoLibrary() : library_(name()) {
    library_.find("cairo_image_surface_create", image_surface_create);
    library_.find("cairo_image_surface_get_data", image_surface_get_data);
    library_.find("cairo_image_surface_get_width", image_surface_get_width);
    library_.find("cairo_image_surface_get_height", image_surface_get_height);
    library_.find("cairo_image_surface_get_stride", image_surface_get_stride);
    library_.find("cairo_surface_flush", surface_flush);
    library_.find("cairo_surface_mark_dirty", surface_mark_dirty);
    library_.find("cairo_surface_write_to_png_stream", surface_write_to_png_stream);
    library_.find("cairo_surface_destroy", surface_destroy);
    library_.find("cairo_status_to_string", status_to_string);
    library_.find("cairo_create", create);
    library_.find("cairo_destroy", destroy);
    library_.find("cairo_scale", scale);
    library_.find("cairo_set_source_rgb", set_source_rgb);
    library_.find("cairo_set_source_rgba", set_source_rgba);
    library_.find("cairo_paint", paint);
    library_.find("cairo_new_path", new_path);
    library_.find("cairo_move_to", move_to);
    library_.find("cairo_line_to", line_to);
    library_.find("cairo_arc", arc);
    library_.find("cairo_close_path", close_path);
    library_.find("cairo_fill", fill);
    library_.find("cairo_stroke", stroke);
    library_.find("cairo_set_line_width", set_line_width);
    library_.find("cairo_set_line_cap", set_line_cap);
    library_.find("cairo_set_line_join", set_line_join);
    library_.find("cairo_select_font_face", select_font_face);
    library_.find("cairo_set_font_size", set_font_size);
    library_.find("cairo_text_extents", text_extents);
    library_.find("cairo_show_text", show_text);
}

const char* CairoLibrary::name() {
    return "libcairo.so.2";
}

}  // namespace pliant::report
