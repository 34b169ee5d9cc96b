// _widget.js: the element <vog-view> in the output of a cell, its files and words from Python, its words to Python. The module of the element
// (docs/web_element.md) comes before these lines.
function render({ model, el }) {
  // The first module of a notebook defines the element.
  const view = document.createElement('vog-view'), element = customElements.get('vog-view');
  const scripts = new Blob([model.get('_esm')], { type: 'text/javascript' });
  element.worker = () => new Worker(URL.createObjectURL(scripts), { type: 'module', name: 'vog-view' });
  const open = () => {
    const files = model.get('files');
    view.files = (name) => files[name] && new Uint8Array(files[name].buffer, files[name].byteOffset, files[name].byteLength);
    view.link = model.get('link');  // another model takes the words of the one before
  };
  const resize = () => { view.style.height = `${model.get('height')}px`; };
  const take = () => { view.link = model.get('sent').replace(/^\d+ /, ''); };
  const heard = { 'change:files': open, 'change:height': resize, 'change:sent': take };
  for (const [name, call] of Object.entries(heard)) model.on(name, call);
  view.style.aspectRatio = 'auto';
  // Keys of the picture are no commands of the notebook: D, D deletes a cell.
  view.dataset.lmSuppressShortcuts = 'true';
  view.addEventListener('keydown', (event) => event.stopPropagation());
  view.on('change', () => {
    model.set('link', view.link);
    model.save_changes();
  });
  view.link = model.get('begin');
  resize();
  open();
  el.append(view);
  return () => {
    for (const [name, call] of Object.entries(heard)) model.off(name, call);
    view.remove();
  };
}
export default { render };
