# filled by the renderer
