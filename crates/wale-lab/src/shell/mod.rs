//! Thin shells of triangles: the continuum that stands between a measured swatch and a yarn tile [Sperl2022, section 5].
