/// @file
/// What a build without expat has in place of the reader of GPX.

bat_status gpx_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    (void)text;
    (void)options;
    (void)set;
    return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "this build of batten does not read GPX, which needs expat");
}
