import './style/page.css';

const app = document.getElementById('app')!;
document.addEventListener('DOMContentLoaded', () => {
  const data = JSON.parse(document.getElementById('report')?.textContent ?? '{}');
  app.textContent = data.verdict?.sentence ?? 'There are no data in this page.';
});
